#pragma once

#include "app/insitu/arrays/kept_field.h"
#include "app/insitu/arrays/passed_step.h"
#include "app/insitu/arrays/ranks.h"
#include "app/insitu/arrays/step_plan.h"
#include "app/insitu/parameters.h"
#include "app/insitu/publisher.h"
#include "app/insitu/session_costs.h"
#include "app/insitu/session_options.h"
#include "app/insitu/step_encoder.h"
#include "app/insitu/step_pace.h"
#include "app/insitu/step_streams.h"
#include "base/noncopyable.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::insitu {

/// Range and error of the values that a rank keeps.
struct KeptFacts {
  FiniteRange range;
  float error = 0;
};

/// Decision of rank 0 about a step, broadcast to all ranks.
struct StepDecision {
  std::uint32_t take = 0, parameters = 0, chunks = 0;
  std::int64_t next_contact = 0;
  std::array<double, Parameters::kMaxParameters> values{};
  std::array<WantedChunk, 8> chunk{};  // chunks that all ranks send now
};

/// Session of one rank (gs_insitu). One thread. On rank 0, the session may own a background thread that encodes.
class InSituSession : NonCopyable {
 public:
  /// Opens a session. Collective. If rank 0 cannot write or serve, returns the problem on all ranks.
  [[nodiscard]] static std::variant<std::unique_ptr<InSituSession>, std::string> open(
      const SessionOptions& options, const gs_insitu_communicator* communicator);
  ~InSituSession();

  [[nodiscard]] int add_parameter(const gs_insitu_parameter& parameter);
  [[nodiscard]] double value(const char* name) const;
  [[nodiscard]] int begin_step(std::int64_t step, double time);
  [[nodiscard]] int pass_block(const gs_insitu_block& block);
  [[nodiscard]] int pass_cells(const gs_insitu_cells& cells);
  [[nodiscard]] int pass_particles(const gs_insitu_particles& particles);
  [[nodiscard]] int end_step();
  [[nodiscard]] int flush();
  [[nodiscard]] int port() const { return publisher_ ? publisher_->port() : 0; }
  [[nodiscard]] const std::string& error() const { return error_; }
  [[nodiscard]] gs_insitu_statistics statistics() const;
  /// Notes an error, and returns `result`.
  int fail(int result, std::string message);

 private:
  using Clock = std::chrono::steady_clock;
  /// Timer that adds the time of its scope to the library's own time.
  class OwnTime;

  InSituSession(const SessionOptions& options, const gs_insitu_communicator* communicator)
      : options_(options), share_(options.max_share), ranks_(communicator), pace_(options.max_share, options.every) {
    ranks_.set_fault(options.fault);
    if (ranks_.is_first()) facts_.resize(static_cast<std::size_t>(ranks_.count()));
    kept_facts_.resize(facts_.size());
  }
  [[nodiscard]] double now() const;
  /// Returns the processor time of the calling thread, plus the time in which the library blocked it. Excludes the time
  /// in which other programs use the processor.
  [[nodiscard]] double spent() const;
  [[nodiscard]] StepPlan make_plan(std::span<const RankFacts> all);
  void decide(std::int64_t step, std::int64_t number, StepDecision& decision);
  void choose_chunks(StepDecision& decision);
  template <class Arrays>
  int pass(const Arrays& arrays);
  [[nodiscard]] bool gather_step(const StepPlan& plan, StepData& data);
  [[nodiscard]] bool keep_step(const StepPlan& plan, StepData& data);
  void serve_kept(const StepPlan& plan, const std::shared_ptr<KeptField>& field, StepData& data);
  [[nodiscard]] bool send_chunks(std::span<const WantedChunk> wanted);
  [[nodiscard]] bool share_permits() const;
  void choose_fields(std::span<const RankFacts> all);
  void log_messages();

  const SessionOptions options_;
  std::atomic<double> share_;  // maximum share of run time; 0 means unlimited
  Ranks ranks_;
  StepPace pace_;
  Parameters parameters_;
  std::deque<std::shared_ptr<KeptField>> kept_;  // newest last
  FiniteRange kept_range_;                       // of this rank's values in the newest of them
  std::uint64_t serial_ = 0;                     // of the newest of them, on rank 0
  std::string error_;
  const char* problem_ = nullptr;  // reason why the open step is incomplete
  // Facts of each rank, on rank 0. Allocated once, so that no allocation can fail between two collective functions.
  std::vector<RankFacts> facts_;
  std::vector<KeptFacts> kept_facts_;
  const Clock::time_point began_ = Clock::now();

  std::int64_t steps_ = 0, next_contact_ = 0;  // number of begun steps; number of the next step at which ranks agree
  bool open_step_ = false;
  std::int64_t step_ = 0;
  double time_ = 0;
  PassedStep passed_;
  std::uint64_t taken_ = 0, peak_bytes_ = 0;
  double slowest_own_ = 0;  // own time of the slowest rank, as far as rank 0 knows
  double step_cost_ = 0;    // time that the library spent in calls for the open step
  double waited_ = 0;       // time in which the output blocked the calling thread

  SessionCosts costs_;
  StepEncoder encoder_{{options_.error, options_.relative_error, options_.threads, options_.title}, costs_};
  std::unique_ptr<Publisher> publisher_;  // rank 0; last member, because its thread uses the others
};

}  // namespace gs::app::insitu
