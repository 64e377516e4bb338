"""Controls a GhostSpace that runs on this machine; needs nothing but Python's own library.

    ghostspace --control /tmp/world.socket --control-token /tmp/world.token world.wrl
    python3 ghostspace_control.py /tmp/world.socket /tmp/world.token

Protocol: docs/control.md.
"""

import base64
import json
import socket
import sys
import time


class GhostSpace:
    """A connection. Services are methods: gs.getNode(node="Box")["node"]."""

    def __init__(self, path, token_file):
        with open(token_file) as file:
            token = file.read().strip()
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(path)
        self.lines = self.socket.makefile("rb")
        self.events = []  # notifications that came while an answer was waited for
        self.last = 0
        self.socket.sendall((token + "\n").encode())

    def send(self, method, **params):
        """Calls a service without waiting for an answer."""
        call = {"jsonrpc": "2.0", "method": method, "params": params}
        self.socket.sendall((json.dumps(call) + "\n").encode())

    def call(self, method, **params):
        """Calls a service; its result."""
        self.last += 1
        call = {"jsonrpc": "2.0", "id": self.last, "method": method, "params": params}
        self.socket.sendall((json.dumps(call) + "\n").encode())
        while True:
            message = self.receive()
            if message.get("id", self.last) != self.last or "method" in message:
                self.events.append(message)
            elif "error" in message:
                raise RuntimeError(message["error"]["message"])
            else:
                return message["result"]

    def receive(self):
        line = self.lines.readline()
        if not line:
            raise EOFError("GhostSpace has ended the connection")
        return json.loads(line)

    def next_event(self):
        """The next notification, waiting for it."""
        return self.events.pop(0) if self.events else self.receive()

    def __getattr__(self, method):
        return lambda **params: self.call(method, **params)


def main(path, token_file, picture=None):
    gs = GhostSpace(path, token_file)
    gs.awaitWorld()
    print("browser:", gs.getName(), gs.getVersion())

    # A box, made of text and put into the world.
    made = gs.createVrmlFromString(
        text="""
        DEF Example Transform {
          children Shape {
            appearance Appearance { material DEF Paint Material { diffuseColor 1 0.4 0.1 } }
            geometry Box {}
          }
        }
        DEF ExampleClock TimeSensor { loop TRUE cycleInterval 1 }"""
    )
    box, clock = made["nodes"]
    names = [one["name"] for one in gs.getInterface(node=box)]
    print("interface:", "translation" in names)

    # A TimeSensor is watched; what it sends comes by itself.
    watch = gs.advise(node=clock, event="fraction_changed")["watch"]
    ticks = 0
    while ticks < 3:
        event = gs.next_event()
        if event["method"] == "event" and event["params"]["watch"] == watch:
            ticks += 1
    gs.unadvise(watch=watch)
    print("ticks:", ticks)

    # Many events that have one timestamp, without waiting for answers.
    for i in range(10):
        gs.send("setValues", events=[["Example", "translation", [i / 10, 0, 0]], ["Paint", "transparency", i / 20]])
        time.sleep(1 / 60)
    print("translation:", gs.getValue(node="Example", event="translation"))

    # Events follow a ROUTE.
    gs.addRoute(**{"from": "Example", "eventOut": "translation", "to": "Example", "eventIn": "scale"})
    gs.setValue(node=box, event="translation", value=[2, 2, 2])
    print("scale:", gs.getValue(node=box, event="scale"))

    gs.replaceWorld(nodes=[box])
    gs.setViewer(position=[2, 2, 14], orientation=[0, 1, 0, 0])
    print("viewer:", gs.getViewer()["position"])
    if picture:
        with open(picture, "wb") as file:
            file.write(base64.b64decode(gs.snapshot(width=320, height=240)["png"]))
    try:
        gs.getNode(node="None")
    except RuntimeError as problem:
        print("problem:", problem)


if __name__ == "__main__":
    main(*sys.argv[1:])
