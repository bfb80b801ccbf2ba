"""gcode2vdb at work: started, listened to, cancelled, and what it left."""

import atexit
import codecs
import json
import os
import re
import shutil
import subprocess
import tempfile
import threading

try:
    import pty
except ImportError:  # Windows: works, without progress
    pty = None

PROGRESS = re.compile(r"^(\w+) .* (\d+) %")
MOST_LINES = 200


class ConversionError(Exception):
    """What went wrong, in words for the user."""


def find_converter(named):
    """The path of gcode2vdb; `named` is the user's own choice or empty. Raises ConversionError."""
    if named:
        if os.path.isfile(named) and os.access(named, os.X_OK):
            return named
        raise ConversionError(f"{named} is not a program; set gcode2vdb in the add-on's preferences")
    beside = os.path.join(os.environ.get("STRATUM_BIN", ""), "gcode2vdb")
    found = beside if os.access(beside, os.X_OK) else shutil.which("gcode2vdb")
    if not found:
        raise ConversionError("gcode2vdb was not found; install Stratum, or name it in the add-on's preferences")
    return found


class Conversion:
    """One run of gcode2vdb in a folder of its own, which lives until close() or cancel()."""

    def __init__(self, converter, source, output_name, options):
        """Starts `converter` on the G-code `source`. Raises ConversionError."""
        self.stage, self.progress = "", 0.0
        self._said = []
        self._folder = tempfile.mkdtemp(prefix="stratum_")
        self._report = os.path.join(self._folder, "report.json")
        command = [converter, source, "-o", os.path.join(self._folder, output_name), "--stats", self._report, *options]
        # gcode2vdb shows its progress on terminals only, so it gets one.
        listening, talking = pty.openpty() if pty else os.pipe()
        try:
            self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=talking)
        except OSError as error:
            os.close(listening)
            shutil.rmtree(self._folder, ignore_errors=True)
            raise ConversionError(f"gcode2vdb can't be started: {error}") from error
        finally:
            os.close(talking)
        # A thread listens all the time: a writer stops when nobody reads what it wrote.
        self._listener = threading.Thread(target=self._listen, args=(listening,), daemon=True)
        self._listener.start()
        atexit.register(self.cancel)

    def _listen(self, listening):
        rest = ""
        decoder = codecs.getincrementaldecoder("utf-8")("replace")
        with os.fdopen(listening, "rb", buffering=0) as stream:
            while True:
                try:
                    part = stream.read(65536)
                except OSError:  # how a terminal says that the other end is closed
                    part = b""
                *lines, rest = re.split(r"[\r\n]+|\x1b\[K", rest + decoder.decode(part, final=not part))
                for line in lines if part else (*lines, rest):
                    self._hear(line.strip())
                if not part:
                    return
                # A bar's line ends when the next one begins.
                self._hear_progress(rest)

    def _hear_progress(self, line):
        match = PROGRESS.match(line)
        if match:
            self.stage, self.progress = match.group(1), int(match.group(2)) / 100
        return match

    def _hear(self, line):
        if line and not self._hear_progress(line):
            self._said = self._said[-MOST_LINES + 1 :] + [line]

    def running(self):
        return self._process.poll() is None or self._listener.is_alive()

    def wait(self, seconds):
        """Returns when it has ended, or after so many seconds."""
        self._listener.join(seconds)

    def result(self):
        """The report of a run that has ended. Raises ConversionError with what gcode2vdb said."""
        self._listener.join()
        status = self._process.wait()
        if status != 0:
            said = self._said[-1] if self._said else f"gcode2vdb ended with {status}"
            raise ConversionError(said)
        with open(self._report, encoding="utf-8") as file:
            return json.load(file)

    def cancel(self):
        """Ends the process if it runs, and removes all that it wrote. May be called again."""
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._listener.join()
        shutil.rmtree(self._folder, ignore_errors=True)
        atexit.unregister(self.cancel)

    close = cancel
