#pragma once

#include "vrml/scene/field_value.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

namespace gs::vrml {

/// State of a time-dependent node (VRML97 4.6.9).
struct TimeState {
  bool active = false;
  bool cycle_sent = false;
  bool delayed = false;  // due to start, but isActive was already sent with that timestamp
  double cycle = 0;      // cycle number at the last step
  double sent_at = -std::numeric_limits<double>::infinity();  // timestamp of the last outputs
  // A set_startTime received while the node was active, and its timestamp: it applies if the node stops at the same
  // time.
  double new_start = 0, new_start_at = -std::numeric_limits<double>::infinity();
};

/// State of an AudioClip or MovieTexture (6.4, 6.28).
struct MediaState {
  bool active = false;
  bool delayed = false;  // see TimeState
  bool told = false;     // the sound or movie has loaded, or its load has failed
  bool holds = false;    // it has been active before
  double duration = -1;  // seconds; negative if unknown
  double cycle = 0;      // last cycle if it does not loop
  double held = 0;       // media position at which it became inactive
  double new_start = 0, new_start_at = -std::numeric_limits<double>::infinity();  // see TimeState
  double stop_set = -std::numeric_limits<double>::infinity();  // time at which stopTime was set while active
};

/// State of a ProximitySensor (6.38) at its last evaluation.
struct ProximityState {
  glm::dvec3 viewer{0};              // position in world space
  double time = 0;                   // timestamp of that position
  std::uint32_t jumps = 0;           // number of viewer jumps until then
  std::uint32_t place = 0;           // last instance of the sensor that contained the viewer
  bool looked = false;               // evaluated at least once while enabled
  bool passed = false;               // the viewer crossed the box between two steps; exitTime is pending
  double left_at = 0;                // exit time of that crossing
  glm::dmat4 sensor_from_left{1.0};  // sensor transform at that time
};

/// State of a pointing-device sensor (4.6.7.3) that the pointer has been over.
struct PointingState {
  bool over = false, active = false;
  bool owes_over = false, owes_active = false;  // FALSE events owed since it was disabled
  std::uint32_t wanted = 0;                     // number of the last pointer update that found it
  std::uint32_t enabled_in = 0;                 // number of the button press during which it was enabled
  // State of a drag since activation (4.6.7.4), in the sensor's coordinate system at activation.
  bool tracks = false;            // that coordinate system is invertible
  bool sent = false;              // a value was sent in this drag
  bool disk = false;              // CylinderSensor: disk mode instead of cylinder mode
  bool far_side = false;          // drags the far side of the cylinder or sphere
  double radius = 0, turned = 0;  // turned: rotation about a CylinderSensor's Y axis in radians, counting full turns
  glm::dvec3 start{0};            // point on the geometry at activation
  glm::dmat4 sensor_from_world{1.0};
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
  std::deque<Kept> kept;        // events received before the program started or had time to run
  bool begins = false;          // url was set
  bool owes_processed = false;  // eventsProcessed() must be called
  double processed_at = -std::numeric_limits<double>::infinity();
};

/// Pool of states of one kind, numbered from 1. Numbers of removed nodes are reused.
template <class T>
class StatePool {
 public:
  [[nodiscard]] T& operator[](std::uint32_t place) { return states_[place]; }
  [[nodiscard]] const T& operator[](std::uint32_t place) const { return states_[place]; }
  /// Reports whether `take` needs no new memory.
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

/// State that behaviours keep for their nodes, indexed by EventNodes::state_of; index 0 means none.
struct BehaviourStates {
  StatePool<TimeState> times;
  StatePool<ProximityState> proximities;
  StatePool<MFVec3f> spares;  // the array that an interpolator writes next
  StatePool<PointingState> pointing;
  StatePool<ScriptState> scripts;
  StatePool<MediaState> media;
};

}  // namespace gs::vrml
