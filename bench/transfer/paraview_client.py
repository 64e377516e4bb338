#!/usr/bin/env pvpython
"""Draws a volume by a remote pvserver: the first picture, then a turn of ten views. Prints a line of JSON per picture.

usage: pvpython paraview_client.py PORT FILE ARRAY LOW HIGH [COMPRESSOR [PICTURE.png]]

All rendering is remote. The client receives pictures of 1024 x 768 pixels: `still` ones as after a movement, without loss, and
`interactive` ones as during a movement, with the compressor. COMPRESSOR, unless it is `default`, replaces the default of ParaView. PICTURE.png gets the last view, after the measurement.
"""
import json
import sys
import time

start = time.monotonic()
import paraview.simple as pv  # noqa: E402

loaded = time.monotonic()


def note(what, **facts):
    print(json.dumps({"what": what, "at": round(time.monotonic() - loaded, 3), **facts}), flush=True)


port, file, array, low, high = int(sys.argv[1]), sys.argv[2], sys.argv[3], float(sys.argv[4]), float(sys.argv[5])
note("loaded", seconds=round(loaded - start, 3))
pv.Connect("127.0.0.1", port)
note("connected")
view = pv.CreateRenderView()
view.ViewSize = [1024, 768]
view.RemoteRenderThreshold = 0
view.EnableRenderOnInteraction = 0
if len(sys.argv) > 6 and sys.argv[6] != "default":
    view.CompressorConfig = sys.argv[6]
reader = pv.OpenDataFile(file)
display = pv.Show(reader, view)
display.SetRepresentationType("Volume")
pv.ColorBy(display, ("POINTS", array))
colours = pv.GetColorTransferFunction(array)
colours.RescaleTransferFunction(low, high)
pv.GetOpacityTransferFunction(array).RescaleTransferFunction(low, high)
pv.ResetCamera(view)
note("shown", compressor=view.CompressorConfig)
view.StillRender()
note("still")
view.InteractiveRender()
note("interactive")
camera = view.GetActiveCamera()
for step in range(10):
    camera.Azimuth(36)
    view.InteractiveRender()
    note("turn", step=step)
view.StillRender()
note("end")
if len(sys.argv) > 7:
    pv.SaveScreenshot(sys.argv[7], view)
