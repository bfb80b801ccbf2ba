"""Films: real ffmpeg makes them, ffprobe and Chromium read them; kills, shards and bad input."""

import base64
import glob
import json
import os
import shutil
import signal
import subprocess
import time

from run_tools import BIN, Scratch, check, gcode, skip_without

skip_without(("ffmpeg", "ffprobe", "chromium", "chromedriver"), ("selenium",))

from chromium import browser

VDBTRACE = os.path.join(BIN, "vdbtrace")
SCRATCH = Scratch("film", VDBTRACE)
FOLDER, path, read, call = SCRATCH.folder, SCRATCH.path, SCRATCH.read, SCRATCH.call
PART = shutil.copy(gcode("tile.gcode"), os.path.join(FOLDER, "part.gcode"))
SMALL = ["--size", "64x48", "--spp", "1", "--quiet"]
QUICK = [*SMALL, "--voxels-per-layer", "2"]


def film(name, *options, source="part.gcode"):
    """Makes a film; returns what --stats says of it."""
    done = call(source, "--film", name, *(SMALL if source.endswith(".vdb") else QUICK), "--stats", "-", *options)
    check(done.returncode == 0, f"{name} {' '.join(options)}: exit {done.returncode}: {done.stderr.strip()}")
    check(not os.path.exists(path(name + ".frames")), f"{name}: no frames are left")
    return json.loads(done.stdout)


def probe(name):
    """Width, height, frames and rate, as ffprobe counts them."""
    text = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                           "stream=width,height,nb_read_frames,avg_frame_rate,codec_name,pix_fmt", "-of", "json", path(name)],
                          capture_output=True, text=True, check=True).stdout
    stream = json.loads(text)["streams"][0]
    above, below = stream["avg_frame_rate"].split("/")
    return (stream["width"], stream["height"], int(stream["nb_read_frames"]), round(int(above) / int(below), 3),
            stream["codec_name"], stream["pix_fmt"])


def pixels(name):
    """A picture, or all frames of a film, as RGB."""
    return subprocess.run(["ffmpeg", "-v", "error", "-i", path(name), "-f", "rawvideo", "-pix_fmt", "rgb24", "-fps_mode",
                           "passthrough", "-"], capture_output=True, check=True).stdout


def frames_of(name):
    return sorted(glob.glob(path(name + ".frames/*.png")))


# --- what ffmpeg makes ----------------------------------------------------------------------------------------------------
for name, rate, codec in (("a.mp4", 30, "h264"), ("a.webm", 30, "vp9"), ("a.gif", 20, "gif")):
    stats = film(name, "--seconds", "0.4", "--nozzle")
    count = round(0.4 * rate)
    found = probe(name)
    check(found[:5] == (64, 48, count, rate, codec), f"{name}: ffprobe finds {found}")
    check(stats["film"]["frames"] == count and stats["film"]["fps"] == rate and stats["film"]["grow"] == "time",
          f"{name}: --stats agrees")
    check(stats["film"]["rendered"] + stats["film"]["repeated"] == count and stats["seconds"]["render"] > 0, "and counts")
check(probe("a.mp4")[5] == "yuv420p" and read("a.mp4").find(b"moov") < read("a.mp4").find(b"mdat"), "an .mp4 that starts fast")
film("b.mp4", "--seconds", "1", "--fps", "12", "--turntable")
check(probe("b.mp4")[2:4] == (12, 12.0), "--fps and --seconds")
film("n.mp4", "--seconds", "0.5", "--fps", "29.97", "--turntable")
check(probe("n.mp4")[2] == 15 and probe("n.mp4")[3] == 29.97, f"29.97 is 30000/1001: {probe('n.mp4')[3]}")

# --- animated PNG: for any number of threads the same, and as the frames are -------------------------------------------------
stats = film("a.png", "--seconds", "1", "--fps", "8", "--nozzle", "--threads", "1")
film("b.png", "--seconds", "1", "--fps", "8", "--nozzle", "--threads", "2")
check(read("a.png") == read("b.png"), "the same bytes for any number of threads")
check(probe("a.png")[:3] == (64, 48, 8), f"ffprobe finds {probe('a.png')}")
one = 3 * 64 * 48
shown = pixels("a.png")
check(len({shown[n * one:(n + 1) * one] for n in range(8)}) == 8, "8 pictures")

page = browser(path("profile"), 400, 300, 60)
try:
    page.get("file://" + os.path.dirname(path("a.png")) + "/")
    found = page.execute_async_script("""
        const [text, done] = arguments;
        (async () => {
            const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
            const decoder = new ImageDecoder({data: bytes, type: "image/png"});
            await decoder.tracks.ready;
            const track = decoder.tracks.selectedTrack;
            const durations = [], seen = [];
            const canvas = new OffscreenCanvas(64, 48), context = canvas.getContext("2d");
            for (let n = 0; n < track.frameCount; ++n) {
                const {image} = await decoder.decode({frameIndex: n});
                durations.push(image.duration);
                context.drawImage(image, 0, 0);
                seen.push(Array.from(context.getImageData(0, 0, 64, 48).data.filter((_, i) => i % 4 != 3)));
            }
            return {animated: track.animated, plays: String(track.repetitionCount), durations, seen};
        })().then(done, error => done({error: String(error)}));
        """, base64.b64encode(read("a.png")).decode())
    check("error" not in found and found["animated"] and found["plays"] == "Infinity", f"Chromium: {found.get('error', 'animated, for ever')}")
    check(found["durations"] == [125000] * 8, f"Chromium: 8 frames of 125 ms: {found['durations']}")
    check(bytes(sum(found["seen"], [])) == shown, "Chromium shows the pixels that ffmpeg decodes")
    page.execute_script("""
        const image = new Image();
        image.id = "film";
        image.src = "data:image/png;base64," + arguments[0];
        document.body.replaceChildren(image);
        """, base64.b64encode(read("a.png")).decode())
    shots, begin = set(), time.monotonic()
    while len(shots) < 3 and time.monotonic() - begin < 30:
        shots.add(page.find_element("id", "film").screenshot_as_base64)
        time.sleep(0.1)
finally:
    page.quit()
check(len(shots) == 3, f"an <img> in Chromium moves: {len(shots)} different pictures")

# --- frames are the pictures of vdbtrace --------------------------------------------------------------------------------------
# Without the prime line, which --printed does not count.
VIEW = ["--eye", "150,-160,120", "--look-at", "100,100,5", "--no-bed"]
film("grow.png", "--grow", "filament", "--seconds", "1", "--fps", "4", *VIEW)
shown = pixels("grow.png")
for n, cut in enumerate(("25%", "50%", "75%", "100%")):
    done = call("part.gcode", "-o", "alone.png", *QUICK, *VIEW, "--printed", cut)
    check(done.returncode == 0 and pixels("alone.png") == shown[n * one:(n + 1) * one], f"frame {n} is --printed {cut}")
film("time.png", "--seconds", "1", "--fps", "4", *VIEW)
check(pixels("time.png")[:one] != shown[:one] and pixels("time.png")[3 * one:] == shown[3 * one:],
      "by time it grows otherwise, up to the same")
done = call("part.gcode", "-o", "turn.png", *QUICK, "--turntable", "4")
film("round.png", "--turntable", "--seconds", "1", "--fps", "4")
shown = pixels("round.png")
for n in range(4):
    check(pixels(f"turn_{n:03}.png") == shown[n * one:(n + 1) * one], f"frame {n} is that of --turntable 4")

# --- level sets turn, prints may grow while they turn, cameras move ------------------------------------------------------------
subprocess.run([os.path.join(BIN, "gcode2vdb"), PART, "-o", path("part.vdb"), "--voxels-per-layer", "2", "--quiet"], check=True)
stats = film("level.png", "--seconds", "1", "--fps", "4", source="part.vdb")
call("part.vdb", "-o", "vdb.png", *SMALL, "--turntable", "4")
check(stats["film"]["turns"] == 1 and stats["film"]["grow"] is None, "a level set turns")
check(pixels("level.png") == b"".join(pixels(f"vdb_{n:03}.png") for n in range(4)), "as its series of pictures does")
stats = film("both.png", "--turntable", "2", "--grow", "time", "--seconds", "1", "--fps", "4")
check(stats["film"]["turns"] == 2 and stats["film"]["grow"] == "time", "both at once, twice round")
KEYS = [{"time": 0, "eye": [150, -160, 120]}, {"time": 1.5, "eye": [-100, 0, 60], "fov": 40}, {"time": 2, "eye": [100, 300, 90]}]
with open(path("path.json"), "w", encoding="utf-8") as file:
    json.dump({"keys": KEYS}, file)
stats = film("path.png", "--camera-path", "path.json", "--fps", "4", "--integrator", "normal")
check(stats["film"]["frames"] == 8 and stats["film"]["seconds"] == 2, "a camera path says how long")
shown = pixels("path.png")
for frame, key in ((0, 0), (7, 2)):
    eye = ",".join(str(x) for x in KEYS[key]["eye"])
    call("part.gcode", "-o", "alone.png", *QUICK, "--eye", eye, "--integrator", "normal")
    check(shown[frame * one:(frame + 1) * one] == pixels("alone.png"), f"frame {frame} is from key {key}")
film("lit.png", "--camera-path", "path.json", "--fps", "4")
call("part.gcode", "-o", "alone.png", *QUICK, "--eye", "150,-160,120")
check(pixels("lit.png")[:one] == pixels("alone.png"), "the light is that of the first key")

# --- stopped and gone on ---------------------------------------------------------------------------------------------------------
LONG = ["part.gcode", "--film", "kill.png", "--size", "128x96", "--spp", "8", "--voxels-per-layer", "2", "--quiet",
        "--seconds", "2", "--fps", "8", "--nozzle"]
whole = call(*LONG)
check(whole.returncode == 0, f"a longer film: {whole.stderr.strip()}")
expected = read("kill.png")
os.remove(path("kill.png"))
running = subprocess.Popen([VDBTRACE, *LONG], cwd=FOLDER)
while len(frames_of("kill.png")) < 3 and running.poll() is None:
    time.sleep(0.01)
running.send_signal(signal.SIGKILL)
running.wait()
kept = len(frames_of("kill.png"))
check(3 <= kept < 16 and not os.path.exists(path("kill.png")), f"killed: {kept} frames are kept, and no film")
other = json.loads(call(*LONG, "--seed", "7", "--shard", "0/16", "--stats", "-").stdout)
check(other["film"]["reused"] == 0, "frames of another scene are not taken")
damaged = frames_of("kill.png")[0]
with open(damaged, "r+b") as file:
    file.truncate(os.path.getsize(damaged) // 2)
done = call(*LONG, "--stats", "-")
went_on = json.loads(done.stdout)["film"]
check(kept - 1 <= went_on["reused"] <= kept and went_on["reused"] + went_on["rendered"] + went_on["repeated"] == 16,
      f"it went on: {went_on}")
check(read("kill.png") == expected, "the same film")
check(not os.path.exists(path("kill.png.frames")), "the frames are gone, also those of the other scene")

# --- several processes -------------------------------------------------------------------------------------------------------------
for shard in ("0/2", "1/2"):
    done = call(*LONG, "--shard", shard, "--shard-by", "frames")
    check(done.returncode == 0, f"shard {shard}: {done.stderr.strip()}")
check(len(frames_of("kill.png")) == 16, "each made its half")
done = json.loads(call(*LONG, "--stats", "-").stdout)["film"]
check(done["reused"] == 16 and done["rendered"] == 0 and read("kill.png") == expected, "the film of all of them, only encoded")

# --- ffmpeg that is not there, or dies -----------------------------------------------------------------------------------------------
os.mkdir(path("empty"))
done = call("part.gcode", "--film", "none.mp4", *QUICK, env={**os.environ, "PATH": path("empty")})
check(done.returncode == 1 and "apt install ffmpeg" in done.stderr and "animated .png" in done.stderr,
      f"no ffmpeg: {done.stderr.strip()}")
done = call("part.gcode", "--film", "none.png", *QUICK, "--seconds", "0.1", env={**os.environ, "PATH": path("empty")})
check(done.returncode == 0 and os.path.exists(path("none.png")), "an animated .png needs none")
for name, script, text in (("dies", "head -c 20000 > /dev/null; kill -9 $$", "was ended by signal 9"),
                           ("poor", "echo \"Unknown encoder 'libx264'\" >&2; exit 1", "Unknown encoder 'libx264'"),
                           ("late", "cat > /dev/null; echo no space >&2; exit 1", "no space")):
    os.mkdir(path(name))
    with open(path(name + "/ffmpeg"), "w", encoding="ascii") as file:
        file.write(f"#!/bin/sh\nPATH={os.environ['PATH']}\n{script}\n")
    os.chmod(path(name + "/ffmpeg"), 0o755)
    for old in (False, True):
        if old:
            with open(path(f"{name}.mp4"), "w", encoding="ascii") as file:
                file.write("by vdbtrace 0.1: old")
        command = ["part.gcode", "--film", f"{name}.mp4", *QUICK, "--seconds", "0.5"]
        done = call(*command, env={**os.environ, "PATH": path(name)})
        check(done.returncode == 1 and text in done.stderr and f"{name}.mp4.frames" in done.stderr,
              f"ffmpeg that {name}: exit {done.returncode}: {done.stderr.strip()}")
        left = [x for x in os.listdir(FOLDER) if x.startswith(f".{name}") or x == f"{name}.mp4"]
        check(left == ([f"{name}.mp4"] if old else []) and (not old or read(f"{name}.mp4") == b"by vdbtrace 0.1: old"), f"no half file: {left}")
    done = call(*command, "--stats", "-")
    check(done.returncode == 0 and json.loads(done.stdout)["film"]["reused"] > 0 and probe(f"{name}.mp4")[2] == 15,
          "the same command with a good one goes on from there")

# --- a hot end in single pictures ------------------------------------------------------------------------------------------------------
call("part.gcode", "-o", "plain.png", *QUICK, "--printed", "50%")
done = call("part.gcode", "-o", "nozzle.png", *QUICK, "--printed", "50%", "--nozzle")
check(done.returncode == 0 and pixels("plain.png") != pixels("nozzle.png"), "--nozzle is in a picture")
done = call("part.gcode", "-o", "series.png", *QUICK, "--progress-series", "2", "--nozzle")
check(pixels("series_000.png") != pixels("series_001.png") and done.returncode == 0, "and in a series")
call("part.gcode", "-o", "mask.exr", *QUICK, "--integrator", "depth", "--nozzle", "--aov", "layer,feature")
check(os.path.exists(path("mask.exr")), "and where no light is")
done = call("part.gcode", "-o", "clear.png", *QUICK, "--printed", "50%", "--clear-nozzle")
plain, solid, clear = pixels("plain.png"), pixels("nozzle.png"), pixels("clear.png")
drawn = [n for n in range(0, len(plain), 3) if plain[n:n + 3] != clear[n:n + 3]]
check(done.returncode == 0 and 20 < len(drawn) < len(plain) / 6, f"--clear-nozzle is in {len(drawn)} pixels and changes no other")
check(clear != solid, "and is another one than --nozzle")

# --- the pace --------------------------------------------------------------------------------------------------------------------------
stats = film("held.png", "--seconds", "1", "--fps", "8", "--hold", "0.25", "--nozzle")
shown = pixels("held.png")
frames = [shown[n * one:(n + 1) * one] for n in range(8)]
call("part.gcode", "-o", "whole.png", *QUICK)
check(len(set(frames[:7])) == 7 and frames[6] == frames[7] == pixels("whole.png"), "--hold shows the finished part, without the hot end")
check(stats["film"]["held"] == 2 and stats["film"]["repeated"] == 1, "and --stats says so")
check(film("long.png", "--seconds", "4", "--fps", "2")["film"]["held"] == 2, "a second of a film of four is held")
check(film("short.png", "--seconds", "3.5", "--fps", "2")["film"]["held"] == 0, "none of a shorter one")
film("layers.png", "--seconds", "1", "--fps", "8", "--grow", "layers")
film("eased.png", "--seconds", "1", "--fps", "8", "--grow", "layers", "--ease", "0.5")
check(len({read(name) for name in ("a.png", "layers.png", "eased.png")}) == 3, "--grow layers and --ease have a pace of their own")

# --- clear refusals ----------------------------------------------------------------------------------------------------------------------
with open(path("typo.json"), "w", encoding="utf-8") as file:
    json.dump({"keys": [{"time": 0, "eye": [1, 2, 3], "lookat": [0, 0, 0]}, {"time": 1, "eye": [2, 2, 3]}]}, file)
with open(path("down.json"), "w", encoding="utf-8") as file:
    json.dump({"keys": [{"time": 0, "eye": [9, 9, 90], "look_at": [9, 9, 0]}, {"time": 1, "eye": [2, 2, 3]}]}, file)
for arguments, status, text in (
        (["part.gcode", "--film", "x.mp4", "--seconds", "0"], 2, "no frames"),
        (["part.gcode", "--film", "x.mp4", "--seconds", "0.01"], 2, "no frames"),
        (["part.gcode", "--film", "x.avi"], 2, ".webm"),
        (["part.gcode", "--film", "x.mp4", "--size", "63x48"], 2, "--size 64x48"),
        (["part.gcode", "--film", "x.gif", "--fps", "60"], 2, "1 to 50"),
        (["part.gcode", "--film", "x.mp4", "--camera-path", "typo.json"], 3, "did you mean 'look_at'"),
        (["part.gcode", "--film", "x.mp4", "--camera-path", "missing.json"], 3, "missing.json"),
        (["part.gcode", "--film", "x.mp4", "--camera-path", "down.json"], 2, "frame 1 of 30"),
        (["part.gcode", "--film", "x.mp4", "--camera-path", "path.json", "--turntable"], 2, "same camera"),
        (["part.gcode", "--film", "x.mp4", "--camera-path", "path.json", "--voxel-size", "auto"], 2, "before one camera"),
        (["part.vdb", "--film", "x.mp4", "--grow", "time"], 2, "needs G-code"),
        (["part.vdb", "--film", "x.mp4", "--nozzle", "--seconds", "0.1"], 2, "needs G-code"),
        (["part.vdb", "-o", "x.png", "--nozzle"], 2, "needs G-code"),
        (["part.gcode", "part.gcode", "--film", "x.mp4"], 2, "several"),
        (["-", "--film", "x.mp4"], 2, "name a file"),
        (["part.gcode", "--film", "x.mp4", "-o", "y.png"], 2, "named by --film"),
        (["part.gcode", "--film", "x.mp4", "--progress-series", "3"], 2, "--grow"),
        (["part.gcode", "--film", "x.mp4", "--grow", "tine"], 2, "time"),
        (["part.gcode", "--film", "x.mp4", "--seconds", "2", "--hold", "2"], 2, "must grow"),
        (["part.gcode", "--film", "x.mp4", "--turntable", "--hold", "1"], 2, "--grow time"),
        (["part.gcode", "--film", "x.mp4", "--seconds", "2", "--ease", "1.5"], 2, "half"),
        (["part.gcode", "--film", "x.mp4", "--camera-path", "path.json", "--ease", "1"], 2, "have times"),
        (["part.gcode", "--film", "x.mp4", "--nozzle", "--clear-nozzle"], 2, "--nozzle"),
        (["part.gcode", "-o", "x.png", "--clear-nozzle", "--integrator", "normal"], 2, "pictures of light"),
        (["part.gcode", "-o", "x.png", "--clear-nozzle", "--shard", "0/2", "--shard-by", "tiles"], 2, "frames"),
        (["part.gcode", "-o", "x.png", "--hold", "1", "--ease", "1"], 2, "--hold, --ease"),
        (["part.gcode", "--film", "no/x.mp4"], 1, "does not exist"),
        (["part.gcode", "--film", "part.gcode"], 2, "must end in"),
        (["part.gcode", "--film", "x.mp4", "--shard", "0/2", "--shard-by", "tiles"], 2, "frames"),
        (["part.gcode", "-o", "x.png", "--seconds", "3", "--grow", "time"], 2, "--seconds, --grow"),
        (["part.gcode", "-o", "x.png", "--turntable"], 2, "how many"),
        (["--turntable", "part.gcode", "-o", "x.png"], 2, "")):
    done = call(*arguments, *[] if "--size" in arguments else SMALL)
    check(done.returncode == status and text in done.stderr, f"{' '.join(arguments)}: exit {done.returncode}: {done.stderr.strip()}")
check(not glob.glob(path("x.*")), "refusals leave nothing behind")

shutil.rmtree(FOLDER)
