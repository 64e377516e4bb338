#pragma once

#include "vrml/events/pointing.h"

#include <optional>
#include <span>

namespace gs::vrml {

/// Playback state of an AudioClip or MovieTexture (VRML97 6.4, 6.28). Times are in seconds since 1970, infinite if
/// undefined.
struct MediaPlay {
  bool active = false, loop = false;
  double start = 0, end = 0;  // of the active period
  double rate = 1;            // pitch or speed
  double duration = -1;       // of the sound or movie at rate 1; negative if unknown
  double position = 0;        // media time in seconds: now, or when it became inactive
};

/// Reports a collision of the avatar with the geometry at the end of the path: sends collideTime of its Collision nodes
/// (6.8) with the present timestamp. Returns false if one of them has collision detection off.
bool collide(Execution& execution, std::span<const PathStep> path);

/// Reports the received fraction, 0 to 1, of a QNV node's data (or of a PROTO instance with its eventOuts). Sends
/// progress_changed if the fraction differs by at least 1/100 from the last one sent or reaches 1; sends loadTime when
/// it first reaches 1 after 0. Returns false if one was already sent with this timestamp; call again after the next
/// step.
bool report_progress(Execution& execution, const SceneGraph& scene, NodeId node, double fraction);

/// Reports that the sound or movie of a node has loaded; `duration` is in seconds, negative if loading failed (6.4,
/// 6.28). Sends duration_changed. Returns false if it was already sent with this timestamp; call again after the next
/// step.
bool report_media(Execution& execution, const SceneGraph& scene, NodeId node, double duration);

/// Returns the playback state of a node; nullopt if it plays no sound or movie.
[[nodiscard]] std::optional<MediaPlay> media_play(Execution& execution, const SceneGraph& scene, NodeId node);

}  // namespace gs::vrml
