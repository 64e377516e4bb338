#pragma once

#include "app/insitu/include/ghostspace/insitu.h"
#include "base/noncopyable.h"

#include <cstddef>
#include <cstdint>
#include <mutex>

namespace gs::app::insitu {

/// Result of encoding a step.
struct EncodedFacts {
  double seconds = 0;  // from the end of the step to the end of its encoding
  std::uint64_t bytes = 0;
  double max_error = 0;
  std::uint32_t thinning = 1;
};

/// Time and bytes that a session used, for its statistics and for its share of run time. Any thread.
class SessionCosts : NonCopyable {
 public:
  /// Adds seconds in the library: `own` counts towards the share, `processor` is processor time.
  void add(double own, double processor);
  /// Charges the processor time of the calling thread since the previous call. Only the server's thread may call it.
  /// `overview` is the time for the last chunk of an overview, or 0.
  void charge_server(double overview, std::size_t bytes);
  void note_step(const EncodedFacts& facts);
  /// Sets the cost of the next step. Chunks below the overview leave this time unused.
  void set_reserve(double seconds);

  [[nodiscard]] double own() const;
  /// Returns the processor time of the last chunk of an overview.
  [[nodiscard]] double overview() const;
  /// Reports whether `share` of `run_seconds` permits chunks below the overview. A share of 0 means unlimited.
  [[nodiscard]] bool permit(double share, double run_seconds) const;
  /// Writes the seconds, the bytes, and the facts of the last step to the statistics.
  void describe(gs_insitu_statistics& all) const;

 private:
  mutable std::mutex mutex_;
  double own_ = 0, processor_ = 0;
  double server_ = 0;  // processor time of the server's thread that `own_` includes
  double overview_ = 0, reserve_ = 0;
  std::uint64_t stream_bytes_ = 0;
  EncodedFacts last_;  // `bytes` is not used
};

}  // namespace gs::app::insitu
