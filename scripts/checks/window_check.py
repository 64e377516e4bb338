#!/usr/bin/env python3
"""window_check.py [-k FOLDER]: uses the window with mouse and keyboard under Xvfb, and checks the results over --control.
Steps: open, split, move, drag a PlaneSensor, follow an Anchor, go back, edit a node and save the world, edit a transfer
function, draw a slice through a volume, show the isosurface and the projection of a stream of values, save a picture
and a turntable, move the viewer by keys of a Script, press buttons of a LayoutLayer in two viewports, use the start
page, close an error message, slide with the middle button, choose data of a surface, add data beside it, and follow a
file that another program writes. Prints one line per step. Exits with 1 if a step failed.
-k: keeps pictures of the window in FOLDER.

GHOSTSPACE: program instead of build/release/ghostspace. Needs Xvfb, xdotool and ImageMagick (Debian: xvfb,
xdotool, imagemagick).
"""

import base64
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs/examples/control"))
from ghostspace_control import GhostSpace  # noqa: E402

WIDTH, HEIGHT = 900, 560
MIDDLE = (WIDTH // 2, 58 + (HEIGHT - 58) // 2)  # centre of the picture, below menu and toolbar

FIRST = """#VRML V2.0 utf8
Viewpoint { position 0 0 10 description "Before it" }
DEF Slider Transform { children [
  DEF Plane PlaneSensor { }
  Shape { appearance Appearance { material Material { diffuseColor 0.8 0.2 0.1 } } geometry Box { } } ] }
Transform { translation 3.5 0 0 children Anchor { url "second.wrl" children
  Shape { appearance Appearance { material Material { diffuseColor 0.1 0.4 0.8 } } geometry Box { } } } }
ROUTE Plane.translation_changed TO Slider.set_translation
"""
SECOND = """#VRML V2.0 utf8
Viewpoint { position 0 0 6 }
Shape { appearance Appearance { material Material { diffuseColor 0.2 0.8 0.3 } } geometry Cone { } }
"""
KEYS = """#VRML V2.0 utf8
Viewpoint { position 0 0 10 }
Shape { geometry Box { } }
DEF S Script { eventIn SFNode key url "javascript:
  function key(e) {
    if (e.type != 'keydown' || e.keyCode != 75) return;
    var ahead = Browser.viewpointOrientation.multVec(new SFVec3f(0, 0, -1));
    Browser.viewpointPosition = Browser.viewpointPosition.add(ahead);
    Browser.setNavigationMode('NONE');
  }" }
ROUTE Browser.event_changed TO S.key
"""


LAYERS = """#X3D V3.3 utf8
PROFILE Immersive
COMPONENT Layering : 1
COMPONENT Layout : 2
LayerSet { order [ 0 1 ] layers LayoutLayer {
  layout Layout { align [ "RIGHT" "BOTTOM" ] sizeUnits "PIXEL" size [ 120 40 ] }
  children [
    DEF T TouchSensor { }
    Shape { appearance Appearance { material Material { diffuseColor 0 0 0 emissiveColor 1 0 0 } }
      geometry Rectangle2D { size 1 1 } } ] } }
Shape { geometry Sphere { radius 3 } appearance Appearance { material Material { diffuseColor 0.1 0.4 0.8 } } }
DEF S Script { inputOnly SFTime touched outputOnly SFInt32 count url "ecmascript:
  var touches = 0;
  function touched() { count = ++touches; }" }
ROUTE T.touchTime TO S.touched
"""
# The conversion takes hours, and the engine does not interrupt it.
HANGS = """#VRML V2.0 utf8
Viewpoint { position 0 0 10 }
Shape { appearance Appearance { material Material { diffuseColor 0.8 0.7 0.1 } } geometry Box { } }
DEF S Script { url "javascript: function initialize() { print(+('0.' + '1'.repeat(1 << 23))); }" }
"""


def surface(size):
    """Returns two triangles with two arrays, as legacy VTK."""
    return f"""# vtk DataFile Version 3.0
surface
ASCII
DATASET POLYDATA
POINTS 4 float
0 0 0 {size} 0 0 0 {size} 0 {size} {size} 1
POLYGONS 2 8
3 0 1 2
3 1 3 2
POINT_DATA 4
SCALARS heat float
LOOKUP_TABLE default
1 2 3 4
VECTORS wind float
3 4 0 0 0 1 0 0 0 9 0 0
"""


def volume():
    """Returns a ball with values that fall from its centre to its rim."""
    size = 32
    lines = ["NRRD0004", "type: uchar", "dimension: 3", f"sizes: {size} {size} {size}", "encoding: ascii", ""]
    half = (size - 1) / 2
    for z in range(size):
        for y in range(size):
            row = []
            for x in range(size):
                r = math.sqrt((x - half) ** 2 + (y - half) ** 2 + (z - half) ** 2) / half
                row.append(str(max(0, int(255 * (1 - r)))))
            lines.append(" ".join(row))
    return "\n".join(lines) + "\n"


def program():
    return os.path.abspath(os.environ.get("GHOSTSPACE", ROOT / "build/release/ghostspace"))


class Failed(Exception):
    pass


class Check:
    def __init__(self, kept):
        self.kept = kept
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="ghostspace-window."))
        self.program = program()
        self.environment = dict(os.environ, HOME=str(self.folder / "home"), XDG_RUNTIME_DIR=str(self.folder))
        for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_PICTURES_DIR",
                     "DBUS_SESSION_BUS_ADDRESS", "WAYLAND_DISPLAY", "XDG_CURRENT_DESKTOP"):
            self.environment.pop(name, None)
        (self.folder / "home").mkdir()
        self.folder.chmod(0o700)
        self.display = self.window = self.world = None
        self.failed = 0

    def file(self, name, text):
        (self.folder / name).write_text(text)
        return str(self.folder / name)

    def start_display(self):
        read, write = os.pipe()
        self.display = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x768x24"],
                                        pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.environment["DISPLAY"] = ":" + number.readline().strip()

    def open(self, *files):
        if self.window:
            self.window.kill()
            self.window.wait()
        socket, token = self.folder / "socket", self.folder / "token"
        for path in (socket, token):
            path.unlink(missing_ok=True)
        self.log = open(self.folder / "log", "a")
        self.window = subprocess.Popen(
            [self.program, "--mute", "--size", f"{WIDTH}x{HEIGHT}", "--control", str(socket), "--control-token",
             str(token), *files], env=self.environment, stderr=self.log, cwd=self.folder)
        wait("the program listens", lambda: socket.exists() and token.exists() and token.stat().st_size > 0)
        self.world = GhostSpace(str(socket), str(token))
        self.world.awaitWorld()
        # Wait until the window shows the current state.
        time.sleep(1.5)

    def xdotool(self, *arguments):
        subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, check=True)

    def key(self, *keys):
        for each in keys:
            self.xdotool("key", each)
            time.sleep(0.4)

    def click(self, place):
        self.xdotool("mousemove", *place)
        time.sleep(0.4)
        self.xdotool("click", 1)
        time.sleep(0.4)

    def drag(self, start, end):
        self.xdotool("mousemove", *start)
        time.sleep(0.4)
        self.xdotool("mousedown", 1)
        for part in range(1, 6):
            time.sleep(0.15)
            self.xdotool("mousemove", *(round(a + (b - a) * part / 5) for a, b in zip(start, end)))
        time.sleep(0.3)
        self.xdotool("mouseup", 1)
        time.sleep(0.4)

    def picture(self):
        """Returns a new picture of the view."""
        return base64.b64decode(self.world.snapshot(width=200, height=150)["png"])

    def differing(self, one, other):
        """Returns the number of pixels that differ visibly in two pictures."""
        for name, data in (("one.png", one), ("other.png", other)):
            (self.folder / name).write_bytes(data)
        result = subprocess.run(["compare", "-metric", "AE", "-fuzz", "4%", "one.png", "other.png", "null:"],
                                cwd=self.folder, capture_output=True, text=True)
        return float(result.stderr.split()[0])

    def step(self, what, work):
        try:
            work()
            print(f"ok      {what}", flush=True)
        except Exception as error:  # continue with the next step
            self.failed += 1
            print(f"FAILED  {what}: {error}", flush=True)
        if self.kept:
            name = "".join(c if c.isalnum() else "-" for c in what) + ".png"
            subprocess.run(["import", "-window", "root", str(pathlib.Path(self.kept) / name)], env=self.environment)

    def end(self):
        for process in (self.window, self.display):
            if process:
                process.kill()
                process.wait()
        if not self.failed:
            shutil.rmtree(self.folder)
        else:
            print(f"files and log: {self.folder}")


def wait(what, holds, seconds=20):
    until = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > until:
            raise Failed(f"{what}: not within {seconds} s")
        time.sleep(0.1)


def near(one, other, margin=1e-3):
    return all(abs(a - b) <= margin for a, b in zip(one, other))


def run(check):
    first, second = check.file("first.wrl", FIRST), check.file("second.wrl", SECOND)
    ball = check.file("ball.nrrd", volume())
    check.start_display()
    check.open(first)

    def slides():
        node = check.world.getNode(node="Slider")["node"]
        before = check.picture()
        check.drag(MIDDLE, (MIDDLE[0] - 90, MIDDLE[1] - 60))
        wait("the box follows the pointer", lambda: check.world.getValue(node=node, event="translation")[0] < -0.5)
        place = check.world.getValue(node=node, event="translation")
        # 8.28 m of the plane at 10 m are 502 pixels high; the dragged face is 9 m away.
        metres = 2 * 9 * math.tan(0.785398 / 2) / (HEIGHT - 58)
        if not near(place, (-90 * metres, 60 * metres, 0), 0.15):
            raise Failed(f"it went to {place}")
        if check.differing(before, check.picture()) < 100:
            raise Failed("its picture is as before")

    def moves():
        before = check.world.getViewer()["position"]
        check.drag((300, 500), (420, 460))
        wait("the viewer moves", lambda: not near(check.world.getViewer()["position"], before, 0.05))
        check.key("ctrl+z")
        wait("the movement is undone", lambda: near(check.world.getViewer()["position"], before, 0.01))

    def splits():
        check.key("ctrl+shift+Right")
        wait("there are two viewports", lambda: len(check.world.getViewports()) == 2)
        check.key("ctrl+w")
        wait("there is one again", lambda: len(check.world.getViewports()) == 1)

    def follows():
        metres = 2 * 10 * math.tan(0.785398 / 2) / (HEIGHT - 58)
        check.key("Home")
        time.sleep(1.5)
        check.click((MIDDLE[0] + round(3.5 / metres), MIDDLE[1]))
        wait("the Anchor leads on", lambda: check.world.getWorldURL().endswith("second.wrl"))
        wait("its Viewpoint is bound", lambda: near(check.world.getViewer()["position"], (0, 0, 6)))

    def goes_back():
        check.key("alt+Left")
        wait("back is the first world", lambda: check.world.getWorldURL().endswith("first.wrl"))
        check.key("alt+Right")
        wait("forward is the second", lambda: check.world.getWorldURL().endswith("second.wrl"))

    def title():
        return subprocess.run(["xdotool", "search", "--name", "GhostSpace", "getwindowname"], env=check.environment,
                              capture_output=True, text=True).stdout

    def viewer_at(z):
        return lambda: near(check.world.getViewer()["position"], (0, 0, z), 0.01)

    def saves():
        check.key("ctrl+shift+t", "ctrl+shift+i")
        check.click((70, 133))  # the Viewpoint in the tree
        check.click((780, 338))  # its position
        check.key("ctrl+a")
        check.xdotool("type", "--delay", 40, "0 0 7")
        check.key("Return")
        wait("the viewer follows its Viewpoint", viewer_at(7))
        wait("the title shows the edit", lambda: "edited" in title())
        check.key("ctrl+z")
        wait("the edit is undone", viewer_at(6))
        if "edited" in title():
            raise Failed("the title still shows the edit")
        check.key("ctrl+y")
        wait("the edit is redone", viewer_at(7))
        check.key("ctrl+q")
        time.sleep(1)
        if check.window.poll() is not None:
            raise Failed("the window is closed without a question")
        check.key("Escape", "ctrl+s", "ctrl+a")
        saved = check.folder / "saved.wrl"
        check.xdotool("type", "--delay", 40, str(saved))
        check.key("Return")
        wait("the world is saved", saved.exists)
        if saved.read_text() != SECOND.replace("0 0 6", "0 0 7"):
            raise Failed(f"it is {saved.read_text()}")
        wait("the title is as before", lambda: "edited" not in title())
        check.key("ctrl+shift+t", "ctrl+shift+i")

    def opens():
        check.key("ctrl+l", "ctrl+a")
        check.xdotool("type", "--delay", 40, ball)
        check.key("Return")
        wait("the volume is open", lambda: check.world.getWorldURL().endswith("ball.nrrd"))
        time.sleep(1.5)

    def edits():
        check.key("F4")
        time.sleep(2)
        check.key("F4", "F4")  # the panel opens at its old position
        time.sleep(1)
        before = window_picture(check)
        check.drag((712, 239), (712, 172))
        time.sleep(2)
        if check.differing(before, window_picture(check)) < 500:
            raise Failed("the picture is as before")
        check.click((628, 528))
        saved = check.folder / "home/Pictures/transfer.json"
        wait("the function is saved", saved.exists)
        points = json.loads(saved.read_text())["points"]
        if not any(abs(point["value"] - 120) < 5 and point["opacity"] > 0.9 for point in points):
            raise Failed(f"no point is where it was dragged to: {points}")

    def keeps():
        check.key("F12")
        wait("a picture is saved", lambda: any(check.folder.glob("home/**/*.png")))
        picture = next(check.folder.glob("home/**/*.png"))
        size = subprocess.run(["identify", "-format", "%k", str(picture)], capture_output=True, text=True).stdout
        if int(size) < 50:
            raise Failed(f"{picture} has {size} colours")

    def slices():
        check.key("F4", "v", "shift+5")  # the volume from above, next to the panel Measure
        check.click((627, 203))  # plane across X
        time.sleep(2)
        before, viewer = window_picture(check), check.world.getViewer()["position"]
        check.drag((260, 309), (330, 309))  # the plane is seen edge-on
        time.sleep(1.5)
        if check.differing(before, window_picture(check)) < 300:
            raise Failed("the picture is as before")
        if not near(check.world.getViewer()["position"], viewer, 1e-6):
            raise Failed("the viewer has moved")
        check.key("v")

    def derives():
        stream = str(check.folder / "values.qnv")
        subprocess.run([check.program, "encode", ball, stream], check=True, capture_output=True)
        check.key("ctrl+l", "ctrl+a")
        check.xdotool("type", "--delay", 40, stream)
        check.key("Return")
        wait("the stream is open", lambda: check.world.getWorldURL().endswith("values.qnv"))
        check.key("v")
        time.sleep(2)
        vectors = window_picture(check)
        check.click((625, 464))  # the isosurface, which hides the vectors
        time.sleep(2)
        surface = window_picture(check)
        if check.differing(vectors, surface) < 500:
            raise Failed("the isosurface is not shown")
        check.drag((727, 464), (775, 464))  # its value
        time.sleep(2)
        if check.differing(surface, window_picture(check)) < 500:
            raise Failed("the isosurface does not follow its value")
        check.click((625, 464))
        check.click((752, 406))  # the list of modes
        check.click((700, 453))  # the maximum along each ray
        time.sleep(2)
        if min(check.differing(one, window_picture(check)) for one in (vectors, surface)) < 500:
            raise Failed("the projection is not shown")
        check.key("v")
        check.key("ctrl+l", "ctrl+a")
        check.xdotool("type", "--delay", 40, ball)
        check.key("Return")
        wait("the volume is open again", lambda: check.world.getWorldURL().endswith("ball.nrrd"))
        time.sleep(1.5)

    def turns():
        check.key("ctrl+shift+p")
        check.xdotool("type", "--delay", 40, "panel pictures")
        check.key("Return")
        time.sleep(1)
        check.click((618, 325))  # one second long
        check.click((599, 383))
        wait("the pictures of a turntable", lambda: len(list(check.folder.glob("home/**/*.0*.png"))) == 25)
        check.click((753, 354))  # as a movie
        check.click((680, 403))
        check.click((599, 383))
        wait("a movie of it", lambda: any(movie.read_bytes()[4:8] == b"ftyp" and movie.stat().st_size > 2000
                                          for movie in check.folder.glob("home/**/*.mp4")))

    def steers():
        check.open(check.file("keys.wrl", KEYS))
        check.xdotool("mousemove", *MIDDLE)
        check.key("k")
        wait("the Script moves the viewer", lambda: near(check.world.getViewer()["position"], (0, 0, 9)))
        check.key("k")
        wait("the viewer moves again", lambda: near(check.world.getViewer()["position"], (0, 0, 8)))
        check.drag((300, 500), (420, 460))
        if not near(check.world.getViewer()["position"], (0, 0, 8)):
            raise Failed("the user moves, although the Script has set the mode NONE")

    def layers():
        check.open(check.file("layers.x3dv", LAYERS))
        node = check.world.getNode(node="S")["node"]

        def pressed(x, touches):
            # The button is 120 x 40 pixels large, in the lower right corner of each viewport.
            if color_at(check, (x - 118, HEIGHT - 38)) != color_at(check, (x - 6, HEIGHT - 6)):
                raise Failed(f"the button does not end at {x}")
            if color_at(check, (x - 122, HEIGHT - 38)) == color_at(check, (x - 118, HEIGHT - 38)):
                raise Failed(f"the button does not begin at {x - 120}")
            check.click((x - 60, HEIGHT - 20))
            wait("the button is pressed", lambda: check.world.getValue(node=node, event="count") == touches)

        pressed(WIDTH, 1)
        check.key("ctrl+shift+Right")
        wait("there are two viewports", lambda: len(check.world.getViewports()) == 2)
        time.sleep(1)
        pressed(WIDTH, 2)
        pressed(WIDTH // 2, 3)
        check.key("ctrl+w")
        wait("there is one again", lambda: len(check.world.getViewports()) == 1)

    def starts():
        check.open(first)
        time.sleep(4)  # the thumbnail is made when the picture rests
        check.key("ctrl+w")
        wait("no file is shown", lambda: not check.world.getViewports()[0]["file"])
        before = window_picture(check)
        # One card, in the middle of the start page
        check.click((WIDTH // 2, 58 + (HEIGHT - 58) // 2 + 40))
        wait("the thumbnail opens its file", lambda: check.world.getViewports()[0]["file"].endswith(".wrl"))
        if check.differing(before, window_picture(check)) < 500:
            raise Failed("the picture is as before")

    def refuses():
        step = check.file("part.step", "ISO-10303-21;\nHEADER;\n")
        before = window_picture(check)
        check.key("ctrl+l", "ctrl+a")
        check.xdotool("type", "--delay", 40, step)
        check.key("Return")
        time.sleep(1.5)
        if check.differing(before, window_picture(check)) < 500:
            raise Failed("there is no message")
        check.key("Escape")
        time.sleep(1)
        if check.differing(before, window_picture(check)) > 500:
            raise Failed("Esc does not close the message")

    def slides_by_middle_button():
        check.key("1")
        before = check.world.getViewer()
        check.xdotool("mousemove", 300, 400)
        check.xdotool("mousedown", 2)
        for x in (330, 360, 400):
            check.xdotool("mousemove", x, 380)
            time.sleep(0.2)
        check.xdotool("mouseup", 2)
        time.sleep(0.5)
        after = check.world.getViewer()
        if near(before["position"], after["position"], 0.05):
            raise Failed("the viewer does not move")
        if not near(before["orientation"], after["orientation"], 1e-3):
            raise Failed("the viewer turns")

    def stops():
        # The card at the bottom has the buttons Reload, Show log and Close.
        def messages():
            return (check.folder / "log").read_text().count("cannot be interrupted")

        (check.folder / "log").touch()
        before = messages()
        check.open(check.file("hangs.wrl", HANGS))
        wait("its Scripts are ended", lambda: messages() == before + 1, 60)
        time.sleep(1)
        check.key("ctrl+shift+Right")
        wait("there are two viewports", lambda: len(check.world.getViewports()) == 2)
        check.key("ctrl+w")
        wait("there is one again", lambda: len(check.world.getViewports()) == 1)
        check.click((MIDDLE[0] - 167, HEIGHT - 30))
        wait("Reload starts the Script again, and it is ended again", lambda: messages() == before + 2, 60)
        time.sleep(1)
        check.click((MIDDLE[0] - 19, HEIGHT - 30))
        wait("Close closes the world", lambda: not check.world.getViewports()[0]["file"])

    def chooses_data():
        check.open("--follow", check.file("surface.vtk", surface(2)))
        check.key("ctrl+shift+d")
        time.sleep(2)
        check.key("ctrl+shift+d", "ctrl+shift+d")  # the panel opens at its old position
        time.sleep(1)
        before = window_picture(check)
        check.click((645, 330))  # Beside
        check.click((670, 371))  # the second array
        wait("there are two viewports", lambda: len(check.world.getViewports()) == 2)
        check.key("ctrl+w")
        wait("there is one again", lambda: len(check.world.getViewports()) == 1)
        time.sleep(1)
        check.click((560, 163))  # the second array
        time.sleep(2)
        if check.differing(before, window_picture(check)) < 2000:
            raise Failed("the picture is as before")

    def follows_file():
        before, viewer = window_picture(check), check.world.getViewer()["position"]
        check.file("surface.vtk", surface(1.2))
        time.sleep(5)
        if check.differing(before, window_picture(check)) < 2000:
            raise Failed("the picture is as before")
        if not near(check.world.getViewer()["position"], viewer):
            raise Failed("the viewer moves")

    check.step("a PlaneSensor is dragged", slides)
    check.step("the viewer moves, and undoes it", moves)
    check.step("a viewport is split, and closed", splits)
    check.step("an Anchor is followed", follows)
    check.step("back and forward", goes_back)
    check.step("a node is edited, and the world is saved", saves)
    check.step("a file is opened by its path", opens)
    check.step("a transfer function is edited, and saved", edits)
    check.step("a slice is drawn by its edge", slices)
    check.step("a stream of values shows its isosurface and its maximum", derives)
    check.step("a picture is saved", keeps)
    check.step("a turntable is saved, as pictures and as a movie", turns)
    check.step("a Script gets keys, and moves the viewer", steers)
    check.step("buttons of a LayoutLayer are pressed in two viewports", layers)
    check.step("the start page opens a recent file", starts)
    check.step("a file of an unknown format is refused, and Esc closes the message", refuses)
    check.step("the middle button slides the viewer", slides_by_middle_button)
    check.step("a world is reloaded and closed after its Script has hung", stops)
    check.step("data of a surface are chosen, and added beside it", chooses_data)
    check.step("a file that a program writes is followed", follows_file)


def color_at(check, place):
    """Returns the colour of a pixel of the window."""
    crop = f"1x1+{place[0]}+{place[1]}"
    return subprocess.run(["import", "-window", "root", "-crop", crop, "+repage", "-depth", "8", "rgb:-"],
                          env=check.environment, check=True, capture_output=True).stdout


def window_picture(check):
    """Returns the left part of the window, with the picture."""
    path = check.folder / "window.png"
    subprocess.run(["import", "-window", "root", "-crop", "500x480+0+60", "+repage", str(path)], env=check.environment,
                   check=True)
    return path.read_bytes()


def main():
    kept = None
    if len(sys.argv) == 3 and sys.argv[1] == "-k":
        kept = sys.argv[2]
        os.makedirs(kept, exist_ok=True)
    elif len(sys.argv) > 1:
        print(__doc__, file=sys.stderr)
        return 2
    missing = [tool for tool in ("Xvfb", "xdotool", "import", "compare") if not shutil.which(tool)]
    if missing:
        print("window_check.py: missing:", *missing, file=sys.stderr)
        return 2
    if not os.access(program(), os.X_OK):
        print(f"window_check.py: {program()} is missing; build it first (scripts/run.sh)", file=sys.stderr)
        return 2
    check = Check(kept)
    try:
        run(check)
    finally:
        check.end()
    return 1 if check.failed else 0


if __name__ == "__main__":
    sys.exit(main())
