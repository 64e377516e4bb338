#pragma once

#include "vrml/scene/field_value.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace gs::vrml {

class Execution;
struct MediaPlay;
struct Node;
struct PointingSensor;
/// A node that takes part in events: its place in Execution. 0 is none.
using EventNode = std::uint32_t;

/// What the nodes of one built-in type do on an event and as time goes: a column of the node table. What no function
/// handles has the common meaning: an exposedField takes the value and sends it (VRML97 4.7), `set_x` of a plain field
/// x replaces that (6.17, 6.18, 6.23, 6.24).
struct Behaviour {
  static constexpr std::size_t kMostEvents = 12;
  /// Names of the interfaces that the functions handle, read or send, "" behind the last one; functions call them by
  /// their places in this list.
  std::array<std::string_view, kMostEvents> events{};
  /// Called once, when the node is found in the world; null where the node takes part only if something is routed.
  void (*initialize)(Execution& execution, EventNode node) = nullptr;
  /// An event for events[event]. False: the event was dealt with, or is ignored. True: it has its common meaning, too.
  bool (*on_event)(Execution& execution, EventNode node, int event, const FieldValue& value) = nullptr;
  /// The time is Execution::now(): in each step while the node runs, at times it asked for, and after events for it
  /// where on_event asked for it.
  void (*on_time)(Execution& execution, EventNode node) = nullptr;
  /// Where a grouping node puts its children, and a Viewpoint the viewer; null: nowhere else.
  glm::dmat4 (*parent_from_local)(const Node& node) = nullptr;
  /// The same of a grouping node that faces the viewer, who is given in its parent's space (6.6).
  glm::dmat4 (*parent_from_facing)(const Node& node, const glm::dvec3& viewer, const glm::dvec3& up) = nullptr;
  /// Of a pointing-device sensor (4.6.7.3, vrml/events/pointing.h); null for all others.
  const PointingSensor* pointing = nullptr;
  /// Of a sensor of where the viewer is (6.38): the middle of where it senses him, in its own coordinates; null for all
  /// others.
  glm::dvec3 (*sensed_place)(const Execution& execution, EventNode node) = nullptr;
  /// Of a node that tells when the avatar meets what is below it (6.8): that it does, if `met`. False: it says that
  /// nothing below it is ever met.
  bool (*on_collision)(Execution& execution, EventNode node, bool met) = nullptr;
  /// An event for an eventIn or exposedField, by its place in the type's interfaces, that the node declares itself.
  void (*on_own_event)(Execution& execution, EventNode node, std::uint32_t interface,
                       const FieldValue& value) = nullptr;
  /// The node is about to be removed; what it sends goes on before.
  void (*before_removal)(Execution& execution, EventNode node) = nullptr;
  /// The node is removed from the world: what state_of names is given back. It sends nothing any more.
  void (*on_remove)(Execution& execution, EventNode node) = nullptr;
  /// The value of its eventOut as long as nothing was sent. False, or null: that of the type.
  bool (*unsent_value)(Execution& execution, EventNode node, FieldValue& value) = nullptr;
  /// Of a node that plays a sound or movie: how long that is, in seconds; negative: it cannot be had. False: not now,
  /// something was told with this timestamp already.
  bool (*media_came)(Execution& execution, EventNode node, double duration) = nullptr;
  /// What of it is played; see Execution::media_play.
  MediaPlay (*media_play)(Execution& execution, EventNode node) = nullptr;
  bool media_backwards = false;  // it can be played backwards, and not at all (6.28)
};

// The rows' behaviours.
extern const Behaviour kTransformBehaviour;
extern const Behaviour kViewpointBehaviour;
extern const Behaviour kProximitySensorBehaviour, kVisibilitySensorBehaviour;
extern const Behaviour kTouchSensorBehaviour, kPlaneSensorBehaviour, kCylinderSensorBehaviour, kSphereSensorBehaviour;
extern const Behaviour kGroupBehaviour;  // addChildren, removeChildren (4.6.5)
extern const Behaviour kAnchorBehaviour, kBillboardBehaviour, kCollisionBehaviour;
extern const Behaviour kBindableBehaviour;  // 4.6.10
inline constexpr int kSetBind = 0;          // of its events
inline constexpr int kFieldOfView = 3;      // of those of Viewpoint
extern const Behaviour kTimeSensorBehaviour;
extern const Behaviour kAudioClipBehaviour, kMovieTextureBehaviour;  // 6.4, 6.28
extern const Behaviour kScriptBehaviour;                             // 6.40
extern const Behaviour kColorInterpolatorBehaviour, kCoordinateInterpolatorBehaviour, kNormalInterpolatorBehaviour,
    kOrientationInterpolatorBehaviour, kPositionInterpolatorBehaviour, kScalarInterpolatorBehaviour,
    kNurbsPositionInterpolatorBehaviour;

}  // namespace gs::vrml
