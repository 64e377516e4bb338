#include "app/insitu/insitu_session.h"

#include "base/thread_time.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

namespace gs::app::insitu {
namespace {

struct OpenResult {
  std::uint32_t failed = 0;
  std::array<char, 252> message{};
};

constexpr const char* kNoMemory = "a rank does not have enough memory for the step; set a smaller max_memory";

}  // namespace

class InSituSession::OwnTime {
 public:
  explicit OwnTime(InSituSession& session) : session_(session) {}
  OwnTime(const OwnTime&) = delete;
  OwnTime& operator=(const OwnTime&) = delete;
  ~OwnTime() { session_.costs_.add(session_.spent() - began_, thread_seconds() - processor_began_); }

 private:
  InSituSession& session_;
  const double began_ = session_.spent();
  const double processor_began_ = thread_seconds();
};

std::variant<std::unique_ptr<InSituSession>, std::string> InSituSession::open(
    const SessionOptions& options, const gs_insitu_communicator* communicator) {
  std::unique_ptr<InSituSession> made(new InSituSession(options, communicator));
  OpenResult result;
  if (made->ranks_.is_first()) {
    auto started = Publisher::start({options.folder,
                                     options.serve,
                                     options.port,
                                     options.bind,
                                     options.token_file,
                                     options.live_file,
                                     options.title,
                                     {[session = made.get()] { return session->share_permits(); },
                                      [session = made.get()](double overview, std::size_t bytes) {
                                        session->costs_.charge_server(overview, bytes);
                                      }}},
                                    made->parameters_);
    if (auto* problem = std::get_if<std::string>(&started)) {
      result.failed = 1;
      std::copy_n(problem->data(), std::min(problem->size(), result.message.size() - 1), result.message.data());
    } else {
      made->publisher_ = std::move(std::get<std::unique_ptr<Publisher>>(started));
      made->encoder_.set_publisher(made->publisher_.get());
    }
  }
  if (!made->ranks_.broadcast(result)) return "the communicator failed";
  if (result.failed != 0) return std::string(result.message.data());
  return made;
}

InSituSession::~InSituSession() { encoder_.wait(); }

double InSituSession::now() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

double InSituSession::spent() const { return thread_seconds() + ranks_.blocked() + waited_; }

int InSituSession::fail(int result, std::string message) {
  error_ = std::move(message);
  if (options_.log) options_.log(error_);
  return result;
}

int InSituSession::add_parameter(const gs_insitu_parameter& parameter) {
  if (steps_ > 0) return fail(GS_INSITU_INVALID, "parameters must be added before the first step");
  if (auto problem = parameters_.add(parameter)) return fail(GS_INSITU_INVALID, std::move(*problem));
  return GS_INSITU_OK;
}

double InSituSession::value(const char* name) const {
  return parameters_.value(name ? name : "").value_or(std::numeric_limits<double>::quiet_NaN());
}

int InSituSession::begin_step(std::int64_t step, double time) {
  if (open_step_) return fail(GS_INSITU_INVALID, "the previous step has not ended; call gs_insitu_end_step() first");
  const std::int64_t number = steps_++;
  if (number < next_contact_) return GS_INSITU_SKIPPED;
  const double begun = spent();
  const OwnTime timer(*this);
  StepDecision decision;
  decision.next_contact = number + 1;
  if (ranks_.is_first() && !ranks_.attempt("decide", [&] { decide(step, number, decision); })) {
    decision = {};
    decision.next_contact = number + 1;
  }
  if (ranks_.is_first()) (void)ranks_.attempt("wanted", [&] { choose_chunks(decision); });
  if (!ranks_.broadcast(decision)) return fail(GS_INSITU_FAILED, "the communicator failed");
  // A rank without memory keeps the former values, so that the calls of all ranks still match.
  if (!ranks_.is_first() && decision.parameters <= decision.values.size())
    (void)ranks_.attempt("parameters", [&] {
      parameters_.set({decision.values.begin(), decision.values.begin() + decision.parameters});
    });
  next_contact_ = decision.next_contact;
  if (decision.chunks > decision.chunk.size() || !send_chunks(std::span(decision.chunk).first(decision.chunks)))
    return fail(GS_INSITU_FAILED, "the communicator failed");
  if (step < 0) return fail(GS_INSITU_INVALID, "the step has a negative number; expected 0 or more");
  if (decision.take == 0) return GS_INSITU_SKIPPED;
  open_step_ = true;
  step_ = step;
  time_ = time;
  step_cost_ = spent() - begun;
  return GS_INSITU_OK;
}

// Decides on rank 0 whether to take the step. Chooses the values of the parameters.
void InSituSession::decide(std::int64_t step, std::int64_t number, StepDecision& decision) {
  if (const auto cost = encoder_.take_cost()) pace_.note_cost(cost->seconds, cost->grid_bytes);
  log_messages();
  const bool wanted = publisher_->is_wanted();
  const double used = std::max(costs_.own(), slowest_own_), at = now();
  const bool take = step >= 0 && wanted && !encoder_.is_busy() && pace_.may_take(number, at, used);
  decision.take = take ? 1 : 0;
  const double interval = publisher_->has_viewer() ? StepPace::kQuickContact : StepPace::kContactSeconds;
  decision.next_contact = number + pace_.steps_until_contact(number, at, used, wanted, interval);
  const std::vector<double> values = parameters_.take_wanted();
  decision.parameters = static_cast<std::uint32_t>(values.size());
  std::ranges::copy(values, decision.values.begin());
}

// Chooses on rank 0 the chunks that all ranks send now. They count as sent, so nothing may fail afterwards.
void InSituSession::choose_chunks(StepDecision& decision) {
  if (ranks_.count() == 1 || !share_permits()) return;
  const std::vector<WantedChunk> chunks = publisher_->take_wanted(decision.chunk.size());
  std::ranges::copy(chunks, decision.chunk.begin());
  decision.chunks = static_cast<std::uint32_t>(chunks.size());
}

int InSituSession::pass_block(const gs_insitu_block& block) { return pass(block); }
int InSituSession::pass_cells(const gs_insitu_cells& cells) { return pass(cells); }
int InSituSession::pass_particles(const gs_insitu_particles& particles) { return pass(particles); }

template <class Arrays>
int InSituSession::pass(const Arrays& arrays) {
  if (!open_step_) return fail(GS_INSITU_INVALID, "no step has begun; pass arrays only if gs_insitu_begin_step() is 1");
  if (auto problem = passed_.add(arrays)) return fail(GS_INSITU_INVALID, std::move(*problem));
  return GS_INSITU_OK;
}

// Publishes the names of the fields that viewers can choose.
void InSituSession::choose_fields(std::span<const RankFacts> all) {
  std::vector<std::string> names;
  for (const RankFacts& rank : all)
    for (const PartFacts* part : {&rank.blocks, &rank.cells, &rank.particles})
      for (std::size_t i = 0; i < part->fields; ++i)
        if (const std::string name = part->field[i].name.data(); std::ranges::find(names, name) == names.end())
          names.push_back(name);
  const std::string shown = !options_.field.empty() ? options_.field : names.empty() ? "" : names.front();
  parameters_.set_fields(std::move(names), shown);
}

bool InSituSession::gather_step(const StepPlan& plan, StepData& data) {
  // A background thread needs copies, because the caller may change its arrays while the thread encodes.
  const bool copy = options_.background;
  const auto keep = [this](auto& list, auto value) {
    if (!ranks_.attempt("list", [&] { list.push_back(std::move(value)); })) problem_ = kNoMemory;
  };
  if (plan.keeps != 0 && !keep_step(plan, data)) return false;
  for (std::size_t i = 0; i < plan.grid_fields; ++i) {
    GridValues values;
    bool complete = true;
    if (!gather_grid(ranks_, passed_.blocks(), plan, plan.grid_field[i], copy, values, complete)) return false;
    if (!complete) problem_ = kNoMemory;
    if (ranks_.is_first() && complete) keep(data.grids, std::move(values));
  }
  std::uint64_t left_out = 0;
  if (plan.has_cells != 0) {
    SurfaceValues values;
    if (!gather_surface(ranks_, passed_.cells(), plan, values, left_out)) return false;
    keep(data.surfaces, std::move(values));
  }
  if (plan.has_particles != 0) {
    ParticleValues values;
    if (!gather_particles(ranks_, passed_.particles(), plan, values)) return false;
    keep(data.particles, std::move(values));
  }
  if (left_out > 0 && options_.log)
    options_.log("step " + std::to_string(step_) + ": " + std::to_string(left_out) +
                 " cells are of unknown types or have invalid indices; they are left out");
  return true;
}

int InSituSession::end_step() {
  if (!open_step_) return fail(GS_INSITU_INVALID, "no step has begun; call gs_insitu_begin_step() first");
  const Clock::time_point ended = Clock::now();
  const double begun = spent();
  std::optional<OwnTime> timer(std::in_place, *this);
  open_step_ = false;
  problem_ = nullptr;
  RankFacts facts;
  bool able = false;
  const bool own_able = ranks_.attempt("facts", [&] { facts = passed_.facts(costs_.own()); });
  bool sound = ranks_.agree(own_able, able) && ranks_.gather(&facts, sizeof facts, facts_.data());
  StepPlan plan;
  if (sound && ranks_.is_first()) {
    const bool planned = able && ranks_.attempt("plan", [&] {
      plan = make_plan(facts_);
      for (const RankFacts& rank : facts_) slowest_own_ = std::max(slowest_own_, rank.own_seconds);
      choose_fields(facts_);
    });
    if (!planned) {
      plan = {};
      std::copy_n(kNoMemory, std::strlen(kNoMemory) + 1, plan.problem.data());
    }
  }
  if (ranks_.is_first() && options_.usual_share) {
    share_ = plan.keeps != 0 ? kShareOfKept : kShareOfEncoded;
    pace_.set_share(share_);
  }
  StepData data{step_, time_, {}, {}, {}, {}};
  sound = sound && ranks_.broadcast(plan) && (plan.problem[0] != 0 || gather_step(plan, data));
  std::uint64_t held_bytes = data.bytes();
  for (const auto& field : kept_) held_bytes += field->bytes();
  peak_bytes_ = std::max(peak_bytes_, held_bytes);
  const std::uint64_t grid_bytes = data.grid_bytes();
  ++taken_;
  if (sound && problem_ == nullptr && plan.problem[0] != 0) problem_ = plan.problem.data();
  bool started = true;
  if (sound && problem_ == nullptr && ranks_.is_first()) {
    const StepCost cost{spent() - begun, grid_bytes};
    started = ranks_.attempt("encode", [&] {
      waited_ += options_.background ? encoder_.start(std::move(data), ended, cost) : encoder_.encode(data, ended);
    });
  }
  passed_.clear();
  if (!sound || problem_ != nullptr) return fail(GS_INSITU_FAILED, sound ? problem_ : "the communicator failed");
  if (!started) return fail(GS_INSITU_FAILED, kNoMemory);
  timer.reset();
  step_cost_ += spent() - begun;
  if (ranks_.is_first() && !options_.background) {
    // The cost includes the overview, because viewers request it for each kept step.
    pace_.note_cost(step_cost_ + (data.served ? costs_.overview() : 0), grid_bytes);
    costs_.set_reserve(pace_.cost());
  }
  log_messages();
  return GS_INSITU_OK;
}

int InSituSession::flush() {
  encoder_.wait();
  log_messages();
  return GS_INSITU_OK;
}

void InSituSession::log_messages() {
  for (std::string& message : encoder_.take_messages()) (void)fail(GS_INSITU_FAILED, std::move(message));
}

gs_insitu_statistics InSituSession::statistics() const {
  gs_insitu_statistics all{};
  all.steps = static_cast<std::uint64_t>(steps_);
  all.taken = taken_;
  all.skipped = all.steps - taken_ - (open_step_ ? 1 : 0);
  all.run_seconds = now();
  all.sent_bytes = ranks_.sent();
  all.peak_bytes = peak_bytes_;
  costs_.describe(all);
  if (!publisher_) all.thinning = 0;
  return all;
}

}  // namespace gs::app::insitu
