#pragma once

#include "vrml/events/execution.h"

#include <deque>
#include <limits>

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

/// What behaviours keep of their nodes, by state_of; [0] is unused.
struct Execution::States {
  std::deque<TimeState> times{1};
  std::deque<MFVec3f> spares{1};  // the array that an interpolator writes next
};

}  // namespace gs::vrml
