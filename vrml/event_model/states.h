#pragma once

#include "vrml/scene/values/field_value.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

namespace gs::vrml {

/// Pauses of an active time-dependent node (X3D 8.2.4).
struct PauseState {
  bool paused = false;
  double since = 0;      // time of the present pause
  double total = 0;      // seconds of the finished pauses since the activation
  double activated = 0;  // time of the activation
};

/// State of a time-dependent node (VRML97 4.6.9).
struct TimeState {
  bool active = false;
  bool cycle_sent = false;
  bool delayed = false;  // must start, but isActive was already sent with this timestamp
  double cycle = 0;      // index of the cycle at the last step
  double sent_at = -std::numeric_limits<double>::infinity();  // timestamp of the last outputs
  // Value and timestamp of a set_startTime event that the node received while active. The value applies if the node
  // stops with the same timestamp.
  double new_start = 0, new_start_at = -std::numeric_limits<double>::infinity();
  PauseState pause;
};

/// State of an AudioClip or MovieTexture (6.4, 6.28).
struct MediaState {
  bool active = false;
  bool delayed = false;  // see TimeState
  bool told = false;     // the sound or movie has loaded, or loading has failed
  bool holds = false;    // the node has been active before
  double duration = -1;  // seconds; negative if unknown
  double cycle = 0;      // index of the last cycle, if it does not loop
  double held = 0;       // media time in seconds at the end of the last active period
  double new_start = 0, new_start_at = -std::numeric_limits<double>::infinity();  // see TimeState
  double stop_set = -std::numeric_limits<double>::infinity();  // time of the last set_stopTime event while active
  PauseState pause;
};

/// Position of the viewer at one time.
struct ViewerMoment {
  glm::dvec3 position{0};  // world space
  double time = 0;
  std::uint32_t jumps = 0;  // number of jumps of the viewer until then
};

/// State of a ProximitySensor (6.38) at its last evaluation.
struct ProximityState {
  ViewerMoment viewer;
  std::uint32_t place = 0;           // index of the last instance of the sensor that contained the viewer
  bool looked = false;               // was evaluated at least once while enabled
  bool passed = false;               // the viewer crossed the box between two steps; exitTime is not sent yet
  double left_at = 0;                // time of exit in that crossing
  glm::dmat4 sensor_from_left{1.0};  // transform of the sensor at that time
};

/// State of a pointing-device sensor (4.6.7.3) that the pointer has been over at least once.
struct PointingState {
  bool over = false, active = false;
  bool owes_over = false, owes_active = false;  // must send isOver FALSE, isActive FALSE because it was disabled
  std::uint32_t wanted = 0;                     // serial number of the last pointer update that found the sensor
  std::uint32_t enabled_in = 0;                 // serial number of the button press during which it was enabled
  // State of a drag (4.6.7.4), in the coordinate system that the sensor had at activation.
  bool tracks = false;                // the coordinate system is invertible
  bool sent = false;                  // the drag has sent a value
  bool disk = false;                  // CylinderSensor: uses disk mode instead of cylinder mode
  bool far_side = false;              // the drag moves the far side of the cylinder or sphere
  double radius = 0, turned = 0;      // turned: CylinderSensor rotation about Y in radians, with full turns
  glm::dvec3 start{0};                // hit point on the geometry at activation
  glm::dmat4 sensor_from_world{1.0};  // after `turn`
  glm::dquat turn{1, 0, 0, 0};        // axisRotation of a sensor of X3D
  bool is_turned = false;             // `turn` is not the identity
};

/// Values of a follower: one for each element of its field.
using FollowerValues = std::vector<glm::dvec4>;

/// State of a chaser or damper (X3D clause 39).
struct FollowerState {
  static constexpr std::size_t kMaxSteps = 64;
  struct Step {
    double time = 0;
    FollowerValues to;
  };
  FollowerValues base;      // chaser: value before all steps; damper: destination
  std::vector<Step> steps;  // chaser: destinations during the last `duration` seconds; damper: outputs of the filters
  double time = 0;          // damper: time of the last evaluation
  bool begun = false;       // the initial values are taken
};

/// State of a Script (6.40).
struct ScriptState {
  static constexpr std::size_t kMaxKept = 10'000;
  static constexpr std::size_t kKeptCost = 16;
  struct Kept {
    std::uint32_t interface = 0;
    FieldValue value;
    double time = 0;
  };
  std::deque<Kept> kept;        // events that wait until the program starts or has time
  bool begins = false;          // url was set; the program must begin
  bool owes_processed = false;  // eventsProcessed() must be called
  double processed_at = -std::numeric_limits<double>::infinity();
};

/// State of an HAnimHumanoid (ISO/IEC 19774): its skeleton, and the skin in the binding pose.
struct HumanoidState {
  struct Joint {
    NodeId node;
    std::uint32_t parent = 0;  // 1 + index of the parent joint; 0 means the humanoid
    glm::dmat4 binding_from_humanoid{1.0};
  };
  std::vector<Joint> joints;                // parents come first
  std::vector<glm::dvec3> points, normals;  // of skinCoord and skinNormal; normals are empty if their number differs
};

/// State of an HAnimMotion.
struct MotionState {
  /// Value that a number of a frame sets.
  enum class Channel : std::uint8_t { none, x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };
  struct Track {
    std::uint32_t joint = 0;        // EventNode of the joint
    std::vector<Channel> channels;  // in the order of the numbers
  };
  std::vector<Track> tracks;
  std::uint32_t humanoid = 0;  // EventNode
  std::size_t number = 0;      // place in the motions of the humanoid
  std::size_t numbers = 0;     // of a frame
  double start = -1;           // time of the first frame; below 0 before it
};

/// State of a LoadSensor (ISO/IEC 19775-1 9.4.3).
struct LoadSensorState {
  bool active = false;
  bool told = false;       // isLoaded was sent for the present state of all watched nodes
  bool timed_out = false;  // timeOut passed; nothing is sent until all watched nodes are loaded
  float fraction = 0;      // last value of progress
  double began = 0;        // time when it became active
};

struct RunningParticles;

/// State of a ParticleSystem (X3D 40.4.5).
struct ParticleState {
  std::shared_ptr<RunningParticles> running;  // null until the system is enabled
  bool active = false;
};

/// Pool of states of one kind. Indices start at 1; indices of removed nodes are used again.
template <class T>
class StatePool {
 public:
  [[nodiscard]] T& operator[](std::uint32_t place) { return states_[place]; }
  [[nodiscard]] const T& operator[](std::uint32_t place) const { return states_[place]; }
  /// Reports whether the next `take` needs no new memory.
  [[nodiscard]] bool has_spare() const { return !free_.empty(); }
  [[nodiscard]] std::uint32_t take() {
    if (free_.empty()) {
      states_.emplace_back();
      return static_cast<std::uint32_t>(states_.size() - 1);
    }
    const std::uint32_t place = free_.back();
    free_.pop_back();
    return place;
  }
  void give_back(std::uint32_t place) {
    if (place == 0) return;
    states_[place] = {};
    free_.push_back(place);
  }

 private:
  std::deque<T> states_{1};
  std::vector<std::uint32_t> free_;
};

/// States that behaviours store for their nodes. EventNodes::state_of is the index; 0 means none.
struct BehaviourStates {
  StatePool<TimeState> times;
  StatePool<ProximityState> proximities;
  StatePool<MFVec3f> spares;       // array that an interpolator writes next
  StatePool<MFVec2f> flat_spares;  // the same for 2D
  StatePool<PointingState> pointing;
  StatePool<ScriptState> scripts;
  StatePool<MediaState> media;
  StatePool<HumanoidState> humanoids;
  StatePool<MotionState> motions;
  StatePool<LoadSensorState> loads;
  StatePool<FollowerState> followers;
  StatePool<ParticleState> particles;
  bool particles_ahead = false;  // systems that start look as if they had run for a lifetime: for still pictures
};

}  // namespace gs::vrml
