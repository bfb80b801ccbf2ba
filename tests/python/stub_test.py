"""The type stub says what the module has: names, members, options, and what mypy makes of both."""

import ast
import inspect
import os
import re
import shutil
import subprocess
import tempfile
import unittest

import stratum
from common import SOURCE, gcode

STUB = os.path.join(SOURCE, "python", "stratum", "__init__.pyi")
with open(STUB, encoding="utf-8") as _file:
    TREE = ast.parse(_file.read())
TUPLES = ("Block", "Hits", "Mesh")


def name_of(node):
    if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
        return node.name
    return node.target.id if isinstance(node, ast.AnnAssign) else None


def members(body):
    return {name_of(node): node for node in body if name_of(node)}


def options_of(call):
    """The options that a function knows, as its error lists them."""
    try:
        call(no_such_option=1)
    except TypeError as error:
        return set(re.search(r"there are (.*)", str(error)).group(1).split(", "))
    raise AssertionError("took an option that there is not")


class Stub(unittest.TestCase):
    def test_every_name(self):
        public = {name for name in members(TREE.body) if not name.startswith("_")}
        self.assertEqual(public, set(stratum.__all__))
        self.assertEqual(public, {name for name in dir(stratum) if not name.startswith("_")})
        self.assertEqual(stratum.__version__.count("."), 2)

    def test_every_member(self):
        for name, node in members(TREE.body).items():
            if not isinstance(node, ast.ClassDef) or name in TUPLES or name.endswith("Error"):
                continue
            told = {member for member in members(node.body) if not member.startswith("__")}
            there = {member for member in vars(getattr(stratum, name)) if not member.startswith("_")}
            self.assertEqual(told, there, name)
            for member, said in members(node.body).items():
                real = inspect.getattr_static(getattr(stratum, name), member)
                decorators = [getattr(d, "id", "") for d in said.decorator_list]
                self.assertEqual("property" in decorators, isinstance(real, property), f"{name}.{member}")
        for name in TUPLES:
            self.assertEqual(tuple(members(members(TREE.body)[name].body)), getattr(stratum, name)._fields)

    def test_bases_of_errors(self):
        for name, base in (("InputError", RuntimeError), ("UsageError", ValueError), ("OutputError", OSError)):
            self.assertEqual(members(TREE.body)[name].bases[0].id, base.__name__)
            self.assertTrue(issubclass(getattr(stratum, name), base))

    def test_every_option(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        level_set = stratum.voxelize(toolpath, voxel_size=0.4)
        top = members(TREE.body)
        of = {name: members(top[name].body) for name in ("Toolpath", "LevelSet", "PrintField", "Intersector")}
        for told, call in (
                (top["read"], lambda **o: stratum.read(gcode("tile.gcode"), **o)),
                (top["voxelize"], lambda **o: stratum.voxelize(toolpath, **o)),
                (top["voxelize_block"], lambda **o: stratum.voxelize_block(toolpath, **o)),
                (top["write_vdb"], lambda **o: stratum.write_vdb(toolpath, "/nowhere/a.vdb", **o)),
                (top["render"], lambda **o: stratum.render(toolpath, **o)),
                (top["report"], lambda **o: stratum.report(toolpath, **o)),
                (top["compare"], lambda **o: stratum.compare(toolpath, "/nowhere/a.stl", **o)),
                (of["Toolpath"]["select"], toolpath.select),
                (of["LevelSet"]["write"], lambda **o: level_set.write("/nowhere/a.vdb", **o)),
                (of["PrintField"]["__init__"], lambda **o: stratum.PrintField(toolpath, **o)),
                (of["Intersector"]["__init__"], lambda **o: stratum.Intersector(level_set, **o))):
            names = [argument.arg for argument in told.args.kwonlyargs]
            self.assertEqual(len(names), len(set(names)))
            self.assertEqual(set(names) - {"progress"}, options_of(call), told.name)

    def test_every_signature(self):
        """inspect.signature() and the stub say the same of every function, class and method."""
        top = members(TREE.body)
        functions = {name: (node, getattr(stratum, name)) for name, node in top.items()
                     if isinstance(node, ast.FunctionDef)}
        for name, node in top.items():
            if not isinstance(node, ast.ClassDef) or name in TUPLES or name.endswith("Error"):
                continue
            for member, said in members(node.body).items():
                if "property" in [getattr(d, "id", "") for d in said.decorator_list]:
                    continue
                if member == "__init__":
                    functions[f"{name}()"] = (said, getattr(stratum, name))
                elif not member.startswith("__"):
                    functions[f"{name}.{member}"] = (said, getattr(getattr(stratum, name), member))
        self.assertGreater(len(functions), 25)
        for name, (said, real) in functions.items():
            parameters = inspect.signature(real).parameters
            plain = [a.arg for a in said.args.args]
            if name.endswith("()"):
                plain.remove("self")
            self.assertEqual([p for p in parameters if parameters[p].kind is not inspect.Parameter.KEYWORD_ONLY], plain, name)
            self.assertEqual({p for p in parameters if parameters[p].kind is inspect.Parameter.KEYWORD_ONLY},
                             {a.arg for a in said.args.kwonlyargs}, name)
            optional = len([p for p in parameters.values()
                            if p.default is not inspect.Parameter.empty and p.kind is not inspect.Parameter.KEYWORD_ONLY])
            self.assertEqual(optional, len(said.args.defaults), name)
        path = stratum.read(gcode("tile.gcode"))
        self.assertEqual(list(inspect.signature(path.select).parameters), ["layers", "features", "objects", "tools"])
        self.assertNotIn("-->", stratum.voxelize.__doc__)

    def test_everything_is_explained(self):
        for name in stratum.__all__:
            thing = getattr(stratum, name)
            if isinstance(thing, type):
                self.assertTrue(thing.__doc__, name)
                for member, value in vars(thing).items():
                    if not member.startswith("_") and name not in TUPLES:
                        self.assertGreater(len(value.__doc__ or ""), 3, f"{name}.{member}")
            elif callable(thing):
                self.assertGreater(len(thing.__doc__), 40, name)

    def test_mypy(self):
        if not shutil.which("mypy"):
            self.skipTest("no mypy")
        with tempfile.TemporaryDirectory() as folder:
            user = os.path.join(folder, "user.py")
            with open(user, "w", encoding="utf-8") as file:
                file.write('import stratum\n'
                           'toolpath = stratum.read("part.gcode", timed=True)\n'
                           'block = stratum.voxelize_block(toolpath, voxel_size=0.1)\n'
                           'reveal_type(block.values)\n'
                           'stratum.render(toolpath, size=(64, 48), view="iso")\n'
                           'stratum.render(toolpath, size="big")\n'
                           'stratum.read("part.gcode", fimware="klipper")\n')
            done = subprocess.run(["mypy", "--strict", "--no-incremental", "--cache-dir", os.path.join(folder, "cache"), STUB,
                                   user], capture_output=True, text=True, check=False,
                                  env={**os.environ, "MYPYPATH": os.path.join(SOURCE, "python")})
        wrong = [line for line in done.stdout.splitlines() if ": error:" in line]
        self.assertEqual(len(wrong), 2, done.stdout + done.stderr)
        self.assertIn("user.py:6", wrong[0])
        self.assertIn("user.py:7", wrong[1])
        self.assertRegex(done.stdout, r"floating\[numpy\._typing\.(_nbit_base\.)?_32Bit\]")


if __name__ == "__main__":
    unittest.main()
