#include "app/insitu/session_costs.h"

#include "base/thread_time.h"

#include <utility>

namespace gs::app::insitu {

void SessionCosts::add(double own, double processor) {
  const std::lock_guard lock(mutex_);
  own_ += own;
  processor_ += processor;
}

void SessionCosts::charge_server(double overview, std::size_t bytes) {
  const double used = thread_seconds();
  const std::lock_guard lock(mutex_);
  const double more = used - std::exchange(server_, used);
  own_ += more;
  processor_ += more;
  if (overview > 0) overview_ = overview;
  stream_bytes_ += bytes;
}

void SessionCosts::note_step(const EncodedFacts& facts) {
  const std::lock_guard lock(mutex_);
  stream_bytes_ += facts.bytes;
  last_ = facts;
}

void SessionCosts::set_reserve(double seconds) {
  const std::lock_guard lock(mutex_);
  reserve_ = seconds;
}

double SessionCosts::own() const {
  const std::lock_guard lock(mutex_);
  return own_;
}

double SessionCosts::overview() const {
  const std::lock_guard lock(mutex_);
  return overview_;
}

bool SessionCosts::permit(double share, double run_seconds) const {
  if (share <= 0) return true;
  const std::lock_guard lock(mutex_);
  return own_ + reserve_ <= share * run_seconds;
}

void SessionCosts::describe(gs_insitu_statistics& all) const {
  const std::lock_guard lock(mutex_);
  all.own_seconds = own_;
  all.processor_seconds = processor_;
  all.last_seconds = last_.seconds;
  all.stream_bytes = stream_bytes_;
  all.max_error = last_.max_error;
  all.thinning = last_.thinning;
}

}  // namespace gs::app::insitu
