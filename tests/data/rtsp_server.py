"""An RTSP camera on loopback for tests, by GStreamer's server: it shows one of some stored views, as H.264.

    rtsp_server.py VIEWS.h264 FOLDER USER PASSWORD

VIEWS.h264 has one image a view, each a key frame that begins with an access unit delimiter. The view shown is the number of photos in FOLDER:
somebody walks on after each photo. The port is printed; the server ends when its standard input does. User and password may be empty.
"""

import glob
import re
import sys

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtsp", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtsp, GstRtspServer

FPS = 15

video, folder, user, password = sys.argv[1:]
stream = open(video, "rb").read()
starts = [match.start() for match in re.finditer(b"\x00\x00\x00\x01\x09", stream)]
views = [stream[start:end] for start, end in zip(starts, starts[1:] + [len(stream)])]
Gst.init(None)


def push(source, _length):
    view = len(glob.glob(folder + "/*.capture.json"))
    buffer = Gst.Buffer.new_wrapped(views[min(view, len(views) - 1)])
    buffer.duration = Gst.SECOND // FPS
    buffer.pts = buffer.dts = source.sent * buffer.duration
    source.sent += 1
    source.emit("push-buffer", buffer)


class Source(GstRtspServer.RTSPMediaFactory):
    def do_configure(self, media):
        source = media.get_element().get_child_by_name("source")
        source.sent = 0
        source.connect("need-data", push)


factory = Source()
factory.set_launch(
    "( appsrc name=source is-live=true block=true format=time max-bytes=1 "
    f"caps=video/x-h264,stream-format=byte-stream,alignment=au,framerate={FPS}/1 "
    "! identity sync=true ! rtph264pay config-interval=-1 name=pay0 )"
)
server = GstRtspServer.RTSPServer()
server.set_address("127.0.0.1")
server.set_service("0")
if user:
    auth = GstRtspServer.RTSPAuth()
    token = GstRtspServer.RTSPToken()
    token.set_string("media.factory.role", "user")
    auth.add_basic(GstRtspServer.RTSPAuth.make_basic(user, password), token)
    server.set_auth(auth)
    factory.add_role_from_structure(Gst.Structure.new_from_string("user,media.factory.access=true,media.factory.construct=true"))
server.get_mount_points().add_factory("/camera", factory)
server.attach(None)
loop = GLib.MainLoop()
GLib.io_add_watch(sys.stdin.fileno(), GLib.PRIORITY_DEFAULT, GLib.IO_HUP | GLib.IO_IN, lambda *_: loop.quit())
print(server.get_bound_port(), flush=True)
loop.run()
