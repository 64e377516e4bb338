#pragma once

#include "base/box.h"
#include "vrml/scene/values/field_value.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace gs::vrml {

class Execution;
class SceneGraph;
struct KeyStroke;
struct MediaPlay;
struct Node;
struct PointingSensor;
struct ViewerMoment;
/// Index of a node in Execution's event tables; 0 means none.
using EventNode = std::uint32_t;

/// Contact of the avatar with geometry. `none` only asks whether collision detection is on.
enum class Meeting : std::uint8_t { none, begins, lasts };

/// Reaction of one built-in node type to events and time; a column of the node table. Events that the functions do not
/// handle have their default meaning. An exposedField takes the value and sends it (VRML97 4.7). `set_x` of a plain
/// field x replaces the value of x (6.17, 6.18, 6.23, 6.24).
struct Behaviour {
  static constexpr std::size_t kMaxEvents = 20;
  /// Names of the interfaces that the functions handle, read or send, padded with "". Functions use the index of a
  /// name.
  std::array<std::string_view, kMaxEvents> events{};
  /// Called once, when the node is found in the world. If null, the node takes part in events only after it gets a
  /// ROUTE.
  void (*initialize)(Execution& execution, EventNode node) = nullptr;
  /// Handles an event for events[event]. If it returns true, the default meaning applies too.
  bool (*on_event)(Execution& execution, EventNode node, int event, const FieldValue& value) = nullptr;
  /// Handles time; Execution::now() is the time. Called in each step while the node runs. Also called at times that the
  /// node has requested, and after events for which on_event requested the call.
  void (*on_time)(Execution& execution, EventNode node) = nullptr;
  /// Returns the transform of a grouping node's children, or of the viewer at a Viewpoint. Null means the identity.
  glm::dmat4 (*parent_from_local)(const SceneGraph& scene, const Node& node) = nullptr;
  /// Returns the transform of a grouping node that faces the viewer (6.6). `viewer` and `up` are in its parent's space.
  glm::dmat4 (*parent_from_facing)(const Node& node, const glm::dvec3& viewer, const glm::dvec3& up) = nullptr;
  /// Pointing-device sensors only (4.6.7.3, vrml/events/pointing.h); null for all other types.
  const PointingSensor* pointing = nullptr;
  /// For sensors of the viewer's position (6.38): returns the centre of the sensed region, in local coordinates.
  glm::dvec3 (*sensed_place)(Execution& execution, EventNode node) = nullptr;
  /// For sensors of the viewer's position: returns a box in world space. While the viewer's path stays outside, on_time
  /// sends nothing. Returns nullopt if on_time must be called in each step.
  std::optional<WideBox> (*idle_box)(Execution& execution, EventNode node) = nullptr;
  /// Updates the state of a sensor for which on_time was not called since idle_box(), as if on_time had been called in
  /// each step up to `last`.
  void (*after_idle)(Execution& execution, EventNode node, const ViewerMoment& last) = nullptr;
  /// For Collision nodes (6.8). Reports the contact of the avatar with a descendant. Returns false if collision
  /// detection is off for all descendants.
  bool (*on_collision)(Execution& execution, EventNode node, Meeting met) = nullptr;
  /// For sensors of keys (X3D clause 21): handles a keystroke. The first name in `events` is `enabled`.
  void (*on_key)(Execution& execution, EventNode node, const KeyStroke& stroke) = nullptr;
  /// Handles an event for an eventIn or exposedField that the node itself declares. `interface` is its index in the
  /// type's interfaces.
  void (*on_own_event)(Execution& execution, EventNode node, std::uint32_t interface,
                       const FieldValue& value) = nullptr;
  /// Called before the node is removed. The events that it sends are still delivered.
  void (*before_removal)(Execution& execution, EventNode node) = nullptr;
  /// Called when the node is removed. Gives the state of EventNodes::state_of back to its pool. Must not send events.
  void (*on_remove)(Execution& execution, EventNode node) = nullptr;
  /// Writes the value of an eventOut before its first event. If the function returns false or is null, that value is
  /// the initial value of the type.
  bool (*unsent_value)(Execution& execution, EventNode node, FieldValue& value) = nullptr;
  /// For nodes that play a sound or movie: takes the duration in seconds; negative means that loading failed. Returns
  /// false if an event was already sent with this timestamp; the caller tries again later.
  bool (*media_came)(Execution& execution, EventNode node, double duration) = nullptr;
  /// For nodes that play a sound or movie: returns the playback state; see vrml::media_play(Execution&, ...).
  MediaPlay (*media_play)(Execution& execution, EventNode node) = nullptr;
  bool media_backwards = false;  // negative and zero speed are allowed (6.28)
  bool watches_routes = false;   // a new ROUTE from the node causes a call of on_time
};

// Behaviours that rows of the node table use.
extern const Behaviour kTransformBehaviour;
extern const Behaviour kHumanoidBehaviour, kJointBehaviour, kSegmentBehaviour, kDisplacerBehaviour, kMotionBehaviour;
extern const Behaviour kViewpointBehaviour;
extern const Behaviour kGeoLocationBehaviour, kGeoTransformBehaviour, kGeoViewpointBehaviour,
    kGeoPositionInterpolatorBehaviour, kGeoProximitySensorBehaviour, kGeoTouchSensorBehaviour, kGeoLodBehaviour;
extern const Behaviour kProximitySensorBehaviour, kVisibilitySensorBehaviour;
extern const Behaviour kTouchSensorBehaviour, kPlaneSensorBehaviour, kCylinderSensorBehaviour, kSphereSensorBehaviour;
extern const Behaviour kLayerSetBehaviour;  // activeLayer (X3D 35.4.2)
extern const Behaviour kGroupBehaviour;     // addChildren, removeChildren (4.6.5)
extern const Behaviour kAnchorBehaviour, kBillboardBehaviour, kCollisionBehaviour;
extern const Behaviour kInlineBehaviour;       // children_changed
extern const Behaviour kBrowserBehaviour;      // the browser as a node (vrml/events/world_browser.h)
extern const Behaviour kBindableBehaviour;     // bindable nodes (4.6.10)
inline constexpr int kSetBind = 0;             // event index of set_bind in all bindable nodes
inline constexpr int kFieldOfView = 3;         // event index of fieldOfView in Viewpoint
inline constexpr int kTransitionComplete = 3;  // event index of transitionComplete in NavigationInfo
extern const Behaviour kTimeSensorBehaviour;
extern const Behaviour kAudioClipBehaviour, kMovieTextureBehaviour;  // 6.4, 6.28
extern const Behaviour kLoadSensorBehaviour;                         // ISO/IEC 19775-1 9.4.3
extern const Behaviour kScriptBehaviour;                             // 6.40
extern const Behaviour kColorInterpolatorBehaviour, kCoordinateInterpolatorBehaviour, kNormalInterpolatorBehaviour,
    kOrientationInterpolatorBehaviour, kPositionInterpolatorBehaviour, kScalarInterpolatorBehaviour,
    kNurbsPositionInterpolatorBehaviour;
extern const Behaviour kNurbsCurvePositionBehaviour, kNurbsOrientationInterpolatorBehaviour,
    kNurbsSurfaceInterpolatorBehaviour;  // of X3D

// Behaviours of X3D (ISO/IEC 19775-1).
extern const Behaviour kOrthoViewpointBehaviour, kNavigationInfoBehaviour;
extern const Behaviour kSwitchBehaviour, kLodBehaviour;  // addChildren, removeChildren, level_changed
extern const Behaviour kBooleanFilterBehaviour, kBooleanSequencerBehaviour, kBooleanToggleBehaviour,
    kBooleanTriggerBehaviour, kIntegerSequencerBehaviour, kIntegerTriggerBehaviour, kTimeTriggerBehaviour;
extern const Behaviour kCoordinateInterpolator2DBehaviour, kPositionInterpolator2DBehaviour, kEaseInEaseOutBehaviour,
    kSplinePositionInterpolatorBehaviour, kSplinePositionInterpolator2DBehaviour, kSplineScalarInterpolatorBehaviour,
    kSquadOrientationInterpolatorBehaviour;
extern const Behaviour kColorChaserBehaviour, kColorDamperBehaviour, kCoordinateChaserBehaviour,
    kCoordinateDamperBehaviour, kOrientationChaserBehaviour, kOrientationDamperBehaviour, kPositionChaserBehaviour,
    kPositionChaser2DBehaviour, kPositionDamperBehaviour, kPositionDamper2DBehaviour, kScalarChaserBehaviour,
    kScalarDamperBehaviour, kTexCoordChaser2DBehaviour, kTexCoordDamper2DBehaviour;
inline constexpr int kKeySensorEnabled = 0;  // event index of enabled in KeySensor and StringSensor
extern const Behaviour kKeySensorBehaviour, kStringSensorBehaviour, kTransformSensorBehaviour;
extern const Behaviour kLinePickSensorBehaviour, kPointPickSensorBehaviour, kPrimitivePickSensorBehaviour,
    kVolumePickSensorBehaviour;
extern const Behaviour kParticleSystemBehaviour;

}  // namespace gs::vrml
