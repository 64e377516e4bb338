#pragma once

#include "vrml/events/execution.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <deque>
#include <limits>
#include <vector>

namespace gs::vrml {

/// A time-dependent node (VRML97 4.6.9).
struct TimeState {
  bool active = false;
  bool cycle_sent = false;
  bool delayed = false;  // due to start, but isActive was sent already with that timestamp
  double cycle = 0;      // number of the cycle of the last step
  double sent_at = -std::numeric_limits<double>::infinity();  // the time that the last outputs are of
  // A set_startTime that came while the node was active, and when: it counts if the node stops at the same time.
  double new_start = 0, new_start_at = -std::numeric_limits<double>::infinity();
};

/// An AudioClip or MovieTexture (6.4, 6.28).
struct MediaState {
  bool active = false;
  bool delayed = false;  // see TimeState
  bool told = false;     // what it has been waiting for has come, or never will
  bool holds = false;    // it has been active
  double duration = -1;  // of the sound or movie, in seconds; negative: not known
  double cycle = 0;      // the cycle that is the last one, where it does not loop
  double held = 0;       // the position at which it became inactive
  double new_start = 0, new_start_at = -std::numeric_limits<double>::infinity();  // see TimeState
  double stop_set = -std::numeric_limits<double>::infinity();                     // when stopTime was, while active
};

/// A ProximitySensor (6.38), since it looked last.
struct ProximityState {
  glm::dvec3 viewer{0};              // in the world
  double time = 0;                   // when he was there
  std::uint32_t jumps = 0;           // of his, until then
  std::uint32_t place = 0;           // the last one of the sensor's in whose box he was
  bool looked = false;               // and was on
  bool passed = false;               // he has gone through the box between two steps, and its end is to be told
  double left_at = 0;                // then
  glm::dmat4 sensor_from_left{1.0};  // then
};

/// A pointing-device sensor (4.6.7.3) that the pointer has been over.
struct PointingState {
  bool over = false, active = false;
  bool owes_over = false, owes_active = false;  // FALSE, since it was disabled
  std::uint32_t wanted = 0;                     // the last look that found it
  std::uint32_t enabled_in = 0;                 // the press during which it was enabled
  // Of drag sensors, since activation (4.6.7.4); in the coordinate system that the sensor had then.
  bool tracks = false;            // that system is no singular one
  bool sent = false;              // a value, in this drag
  bool disk = false;              // of a CylinderSensor, rather than its cylinder
  bool far_side = false;          // of the cylinder or sphere, as seen along the bearing
  double radius = 0, turned = 0;  // turned: radians about the Y axis of a CylinderSensor, over full turns too
  glm::dvec3 start{0};            // the point that was pointed at
  glm::dmat4 sensor_from_world{1.0};
};

/// A Script (6.40).
struct ScriptState {
  static constexpr std::size_t kMostKept = 10'000;
  static constexpr std::size_t kKeptCost = 16;
  struct Kept {
    std::uint32_t interface = 0;
    FieldValue value;
    double time = 0;
  };
  std::deque<Kept> kept;        // events that have come before the program, or before there was time for them
  bool begins = false;          // its url was set
  bool owes_processed = false;  // eventsProcessed() is to be called
  double processed_at = -std::numeric_limits<double>::infinity();
};

/// States of one kind, by number from 1; those of removed nodes are used again.
template <class T>
class StatePool {
 public:
  [[nodiscard]] T& operator[](std::uint32_t place) { return states_[place]; }
  [[nodiscard]] const T& operator[](std::uint32_t place) const { return states_[place]; }
  /// Whether `take` needs no new memory.
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

/// What behaviours keep of their nodes, by state_of; 0 is none.
struct Execution::States {
  StatePool<TimeState> times;
  StatePool<ProximityState> proximities;
  StatePool<MFVec3f> spares;  // the array that an interpolator writes next
  StatePool<PointingState> pointing;
  StatePool<ScriptState> scripts;
  StatePool<MediaState> media;
};

}  // namespace gs::vrml
