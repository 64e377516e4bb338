#pragma once

#include "vrml/events/pointing.h"

#include <optional>
#include <span>

namespace gs::vrml {

/// Playback state of an AudioClip or MovieTexture (VRML97 6.4, 6.28). Times are in seconds since 1970. Undefined times
/// are infinite.
struct MediaPlay {
  bool active = false, loop = false;
  double start = 0, end = 0;  // start and end of the active period
  double rate = 1;  // pitch of a sound, speed of a movie
  double duration = -1;  // seconds at rate 1; negative if unknown
  double position = 0;  // media time in seconds: now, or at the end of the last active period
};

/// Reports a collision of the avatar with the geometry at the end of `path`. The Collision nodes on the path send
/// collideTime (6.8) with the present timestamp. If the avatar only stays in contact (`meeting` is `lasts`), isActive
/// of X3D stays TRUE. Returns false if one of the nodes has collision detection off.
bool collide(Execution& execution, std::span<const PathStep> path, Meeting meeting = Meeting::begins);

/// Reports that the viewer has reached a Viewpoint. The bound NavigationInfo sends transitionComplete (X3D 23.4.4).
void report_transition(Execution& execution);

/// Reports the received fraction, 0 to 1, of the data of a QNV node, or of a PROTO instance with the same eventOuts.
/// Sends progress_changed if the fraction reaches 1, or differs by at least 1/100 from the last value sent. Sends
/// loadTime when the fraction first reaches 1 after 0. Returns false if an event was already sent with this timestamp;
/// call again after the next step.
bool report_progress(Execution& execution, const SceneGraph& scene, NodeId node, double fraction);

/// Reports that the sound or movie of a node has loaded, or that loading failed (6.4, 6.28). `duration` is in seconds;
/// negative means failed. Sends duration_changed. Returns false if that event was already sent with this timestamp;
/// call again after the next step.
bool report_media(Execution& execution, const SceneGraph& scene, NodeId node, double duration);

/// Returns the playback state of a node. Returns nullopt if its type plays no sound or movie.
[[nodiscard]] std::optional<MediaPlay> media_play(Execution& execution, const SceneGraph& scene, NodeId node);

}  // namespace gs::vrml
