#include "app/insitu/insitu_session.h"

#include "base/thread_time.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

namespace gs::app::insitu {
namespace {

struct OpenResult {
  std::uint32_t failed = 0;
  std::array<char, 252> message{};
};

template <class View>
PartFacts facts_of_parts(const std::vector<View>& parts) {
  PartFacts facts;
  facts.parts = static_cast<std::uint32_t>(parts.size());
  if (parts.empty()) return facts;
  const auto& fields = parts.front().fields;
  facts.fields = static_cast<std::uint32_t>(std::min(fields.size(), kMaxFields));
  for (std::size_t i = 0; i < facts.fields; ++i) facts.field[i] = facts_of(fields[i]);
  return facts;
}

// Default shares of run time: for grids that ranks keep for requests, and for other data. Other data are encoded at
// once, so their first picture costs more.
constexpr double kShareOfKept = 0.02, kShareOfEncoded = 0.1;

constexpr const char* kNoMemory = "a rank does not have enough memory for the step; set a smaller max_memory";

std::string text_or(const char* text, const char* fallback) { return text && *text ? text : fallback; }

}  // namespace

class InSituSession::OwnTime {
 public:
  explicit OwnTime(InSituSession& session) : session_(session), shared_(session.shared_) {}
  OwnTime(const OwnTime&) = delete;
  OwnTime& operator=(const OwnTime&) = delete;
  ~OwnTime() {
    const std::lock_guard lock(shared_.mutex);
    shared_.own_seconds += session_.spent() - began_;
    shared_.processor_seconds += thread_seconds() - processor_began_;
  }

 private:
  InSituSession& session_;
  Shared& shared_;
  const double began_ = session_.spent();
  const double processor_began_ = thread_seconds();
};

std::variant<SessionOptions, std::string> session_options(const gs_insitu_options& given) {
  gs_insitu_options options;
  gs_insitu_options_init(&options, sizeof options);
  if (given.size < sizeof(std::size_t) || given.size > sizeof options)
    return "the options come from a newer version of the header; expected version " +
           std::to_string(GS_INSITU_VERSION) + ", and gs_insitu_options_init() before";
  std::memcpy(&options, &given, given.size);
  SessionOptions result;
  result.title = text_or(options.title, "simulation");
  result.folder = text_or(options.folder, "");
  result.bind = text_or(options.bind, "127.0.0.1");
  result.token_file = text_or(options.token_file, "");
  result.live_file = text_or(options.live_file, "");
  result.field = text_or(options.field, "");
  result.serve = options.serve != 0;
  result.background = options.background != 0;
  result.thin = options.thin != 0;
  if (options.port < 0 || options.port > 65535)
    return "port " + std::to_string(options.port) + " is out of range; expected 0 to 65535";
  result.port = static_cast<std::uint16_t>(options.port);
  if (!(options.error >= 0) || !std::isfinite(options.error) || !(options.relative_error >= 0) ||
      !(options.relative_error < 1))
    return "the error is invalid; expected an error of 0 or more, and a relative_error from 0 to below 1";
  if (options.error == 0 && options.relative_error == 0)
    return "the error is 0; expected an error or a relative_error above 0";
  result.error = options.error;
  result.relative_error = options.relative_error;
  const bool usual = options.max_share == GS_INSITU_USUAL_SHARE;
  if (!usual && (!(options.max_share >= 0) || !(options.max_share <= 1)))
    return "max_share is invalid; expected 0 to 1, or GS_INSITU_USUAL_SHARE";
  result.usual_share = usual && result.serve && result.folder.empty();
  result.max_share = !usual ? options.max_share : result.usual_share ? kShareOfKept : 0;
  if (options.every < 1) return "every is " + std::to_string(options.every) + "; expected 1 or more";
  result.every = options.every;
  result.max_memory = std::max<std::uint64_t>(options.max_memory, 1);
  result.threads = static_cast<unsigned>(std::clamp(options.threads, 1, 256));
  if (!result.serve && result.folder.empty()) return "there is no output; expected a folder, or serve = 1";
  if (options.log)
    result.log = [log = options.log, context = options.log_context](const std::string& message) {
      log(context, message.c_str());
    };
  return result;
}

std::variant<std::unique_ptr<InSituSession>, std::string> InSituSession::open(
    const SessionOptions& options, const gs_insitu_communicator* communicator) {
  std::unique_ptr<InSituSession> made(new InSituSession(options, communicator));
  OpenResult result;
  if (made->ranks_.is_first()) {
    auto started = Publisher::start(
        {options.folder,
         options.serve,
         options.port,
         options.bind,
         options.token_file,
         options.live_file,
         options.title,
         {[session = made.get()] { return session->share_permits(); },
          [session = made.get()](double overview, std::size_t bytes) { session->charge_server(overview, bytes); }}},
        made->parameters_);
    if (auto* problem = std::get_if<std::string>(&started)) {
      result.failed = 1;
      std::copy_n(problem->data(), std::min(problem->size(), result.message.size() - 1), result.message.data());
    } else {
      made->publisher_ = std::move(std::get<std::unique_ptr<Publisher>>(started));
    }
  }
  if (!made->ranks_.broadcast(result)) return "the communicator failed";
  if (result.failed != 0) return std::string(result.message.data());
  return made;
}

InSituSession::~InSituSession() { wait_for_background(); }

double InSituSession::now() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

double InSituSession::spent() const { return thread_seconds() + ranks_.blocked() + waited_; }

double InSituSession::own() const {
  const std::lock_guard lock(shared_.mutex);
  return shared_.own_seconds;
}

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

// Decides on rank 0 whether the step is taken, and what the ranks send.
void InSituSession::decide(std::int64_t step, std::int64_t number, StepDecision& decision) {
  bool busy = false;
  {
    const std::lock_guard lock(shared_.mutex);
    busy = shared_.busy;
    if (std::exchange(shared_.cost_is_new, false)) pace_.note_cost(shared_.cost, shared_.cost_bytes);
  }
  log_messages();
  const bool wanted = publisher_->is_wanted();
  const double used = std::max(own(), slowest_own_), at = now();
  const bool take = step >= 0 && wanted && !busy && pace_.may_take(number, at, used);
  decision.take = take ? 1 : 0;
  const double interval = publisher_->has_viewer() ? StepPace::kQuickContact : StepPace::kContactSeconds;
  decision.next_contact = number + pace_.steps_until_contact(number, at, used, wanted, interval);
  if (ranks_.count() > 1 && share_permits()) {
    const std::vector<WantedChunk> chunks = publisher_->take_wanted(decision.chunk.size());
    std::ranges::copy(chunks, decision.chunk.begin());
    decision.chunks = static_cast<std::uint32_t>(chunks.size());
  }
  const std::vector<double> values = parameters_.take_wanted();
  decision.parameters = static_cast<std::uint32_t>(values.size());
  std::ranges::copy(values, decision.values.begin());
}

int InSituSession::pass_block(const gs_insitu_block& block) {
  if (!open_step_) return fail(GS_INSITU_INVALID, "no step has begun; pass arrays only if gs_insitu_begin_step() is 1");
  if (block.size < sizeof block) return fail(GS_INSITU_INVALID, "the size of a block is wrong; set `size` to sizeof");
  auto view = block_view(block);
  if (auto* problem = std::get_if<std::string>(&view)) return fail(GS_INSITU_INVALID, std::move(*problem));
  blocks_.push_back(std::move(std::get<BlockView>(view)));
  if (!(blocks_.back().grid == blocks_.front().grid)) {
    blocks_.pop_back();
    return fail(GS_INSITU_INVALID, "two blocks name different grids; expected equal whole_extent, origin and spacing");
  }
  return GS_INSITU_OK;
}

int InSituSession::pass_cells(const gs_insitu_cells& cells) {
  if (!open_step_) return fail(GS_INSITU_INVALID, "no step has begun; pass arrays only if gs_insitu_begin_step() is 1");
  if (cells.size < sizeof cells) return fail(GS_INSITU_INVALID, "the size of cells is wrong; set `size` to sizeof");
  auto view = cells_view(cells);
  if (auto* problem = std::get_if<std::string>(&view)) return fail(GS_INSITU_INVALID, std::move(*problem));
  cells_.push_back(std::move(std::get<CellsView>(view)));
  return GS_INSITU_OK;
}

int InSituSession::pass_particles(const gs_insitu_particles& particles) {
  if (!open_step_) return fail(GS_INSITU_INVALID, "no step has begun; pass arrays only if gs_insitu_begin_step() is 1");
  if (particles.size < sizeof particles)
    return fail(GS_INSITU_INVALID, "the size of particles is wrong; set `size` to sizeof");
  auto view = particles_view(particles);
  if (auto* problem = std::get_if<std::string>(&view)) return fail(GS_INSITU_INVALID, std::move(*problem));
  particles_.push_back(std::move(std::get<ParticlesView>(view)));
  return GS_INSITU_OK;
}

RankFacts InSituSession::own_facts() const {
  RankFacts facts;
  facts.blocks = facts_of_parts(blocks_);
  facts.cells = facts_of_parts(cells_);
  facts.particles = facts_of_parts(particles_);
  if (!blocks_.empty()) facts.grid = blocks_.front().grid;
  for (const BlockView& block : blocks_) {
    std::uint64_t points = 1;
    for (const std::size_t low : {0U, 2U, 4U})
      points *= static_cast<std::uint64_t>(block.extent[low + 1] - block.extent[low] + 1);
    facts.blocks.count += points;
  }
  for (const CellsView& view : cells_) add_bounds(view, facts.cells);
  for (const ParticlesView& view : particles_) add_bounds(view, facts.particles);
  facts.own_seconds = own();
  return facts;
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
    if (!gather_grid(ranks_, blocks_, plan, plan.grid_field[i], copy, values, complete)) return false;
    if (!complete) problem_ = kNoMemory;
    if (ranks_.is_first() && complete) keep(data.grids, std::move(values));
  }
  std::uint64_t left_out = 0;
  if (plan.has_cells != 0) {
    SurfaceValues values;
    if (!gather_surface(ranks_, cells_, plan, values, left_out)) return false;
    keep(data.surfaces, std::move(values));
  }
  if (plan.has_particles != 0) {
    ParticleValues values;
    if (!gather_particles(ranks_, particles_, plan, values)) return false;
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
  const bool own_able = ranks_.attempt("facts", [&] { facts = own_facts(); });
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
  if (!sound || problem_ != nullptr) {
    clear_step();
    return fail(GS_INSITU_FAILED, sound ? problem_ : "the communicator failed");
  }
  if (ranks_.is_first()) {
    if (options_.background) {
      const double cost = spent() - begun;
      {
        const std::lock_guard lock(shared_.mutex);
        shared_.cost = cost;
        shared_.cost_bytes = grid_bytes;
      }
      start_background(std::move(data), ended);
    } else {
      waited_ += encode_and_publish(data, ended);
    }
  }
  clear_step();
  timer.reset();
  step_cost_ += spent() - begun;
  if (ranks_.is_first() && !options_.background) {
    // The cost includes the overview, because viewers request it for each kept step.
    const std::lock_guard lock(shared_.mutex);
    pace_.note_cost(step_cost_ + (data.served ? shared_.overview_seconds : 0), grid_bytes);
    shared_.reserve = pace_.cost();
  }
  log_messages();
  return GS_INSITU_OK;
}

void InSituSession::clear_step() {
  blocks_.clear();
  cells_.clear();
  particles_.clear();
}

// Encodes and publishes a step. Returns the seconds in which the output blocked without using the processor.
double InSituSession::encode_and_publish(const StepData& data, Clock::time_point ended) {
  double waited = 0;
  std::vector<std::string> problems;
  std::uint64_t bytes = 0;
  double error = 0;
  std::uint32_t thinning = 1;
  try {
    std::vector<StepStream> streams =
        encode_step(data, {options_.error, options_.relative_error, options_.threads, options_.title}, problems);
    for (const StepStream& stream : streams) {
      bytes += stream.bytes.size();
      error = std::max(error, stream.max_error);
      thinning = std::max(thinning, stream.thinning);
    }
    const Clock::time_point begun = Clock::now();
    const double processor = thread_seconds();
    if (auto problem = publisher_->publish(data.step, data.time, std::move(streams)))
      problems.push_back(std::move(*problem));
    const double passed = std::chrono::duration<double>(Clock::now() - begun).count();
    waited = std::max(passed - (thread_seconds() - processor), 0.0);
  } catch (const std::bad_alloc&) {
    problems.emplace_back("not enough memory to encode step " + std::to_string(data.step));
  } catch (const std::exception& problem) {
    problems.emplace_back("step " + std::to_string(data.step) + " cannot be encoded: " + problem.what());
  }
  const std::lock_guard lock(shared_.mutex);
  shared_.last_seconds = std::chrono::duration<double>(Clock::now() - ended).count();
  shared_.stream_bytes += bytes;
  shared_.max_error = error;
  shared_.thinning = thinning;
  std::ranges::move(problems, std::back_inserter(shared_.messages));
  return waited;
}

void InSituSession::start_background(StepData data, Clock::time_point ended) {
  wait_for_background();
  {
    const std::lock_guard lock(shared_.mutex);
    shared_.busy = true;
  }
  const auto held = std::make_shared<StepData>(std::move(data));
  const auto work = [this, held, ended] {
    (void)encode_and_publish(*held, ended);
    const double used = thread_seconds();
    const std::lock_guard lock(shared_.mutex);
    shared_.own_seconds += used;
    shared_.processor_seconds += used;
    shared_.cost += used;
    shared_.cost_is_new = true;
    shared_.busy = false;
  };
  try {
    background_ = std::thread(work);
  } catch (const std::system_error&) {
    waited_ += encode_and_publish(*held, ended);
    const std::lock_guard lock(shared_.mutex);
    shared_.busy = false;
  }
}

void InSituSession::wait_for_background() {
  if (background_.joinable()) background_.join();
}

int InSituSession::flush() {
  wait_for_background();
  log_messages();
  return GS_INSITU_OK;
}

void InSituSession::log_messages() {
  std::vector<std::string> messages;
  {
    const std::lock_guard lock(shared_.mutex);
    messages.swap(shared_.messages);
  }
  for (std::string& message : messages) (void)fail(GS_INSITU_FAILED, std::move(message));
}

gs_insitu_statistics InSituSession::statistics() const {
  gs_insitu_statistics all{};
  all.steps = static_cast<std::uint64_t>(steps_);
  all.taken = taken_;
  all.skipped = all.steps - taken_ - (open_step_ ? 1 : 0);
  all.run_seconds = now();
  all.sent_bytes = ranks_.sent();
  all.peak_bytes = peak_bytes_;
  const std::lock_guard lock(shared_.mutex);
  all.own_seconds = shared_.own_seconds;
  all.processor_seconds = shared_.processor_seconds;
  all.last_seconds = shared_.last_seconds;
  all.stream_bytes = shared_.stream_bytes;
  all.max_error = shared_.max_error;
  all.thinning = publisher_ ? shared_.thinning : 0;
  return all;
}

}  // namespace gs::app::insitu
