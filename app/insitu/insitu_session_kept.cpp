// Grids that ranks keep, and chunks of them that viewers request.
#include "app/insitu/insitu_session.h"

#include <algorithm>
#include <utility>

namespace gs::app::insitu {

bool InSituSession::share_permits() const { return costs_.permit(share_, now()); }

StepPlan InSituSession::make_plan(std::span<const RankFacts> all) {
  const std::string chosen = parameters_.field();
  PlanWishes wishes;
  wishes.all_fields = !options_.folder.empty();
  wishes.field = chosen.empty() ? options_.field : chosen;
  // Files need whole grids. Without files, nothing is encoded before a viewer requests it.
  wishes.keep = options_.folder.empty();
  // Codes of 16 bits may not meet an absolute or a small relative error bound.
  constexpr double kErrorOfCodes = 1e-4;
  wishes.kept_bytes = options_.error > 0 || options_.relative_error < kErrorOfCodes ? sizeof(float) : 2;
  wishes.serial = serial_ + 1;
  if (options_.thin) wishes.max_collected = pace_.affordable_bytes(steps_ - 1, now(), costs_.own());
  wishes.max_memory = options_.max_memory;
  wishes.max_records = options_.max_memory;
  return plan_step(all, wishes);
}

bool InSituSession::keep_step(const StepPlan& plan, StepData& data) {
  if (publisher_) publisher_->drop_older();
  std::shared_ptr<KeptField> field;
  if (kept_.size() >= kKeptSteps) {
    field = std::move(kept_.front());
    kept_.pop_front();
  }
  std::vector<Chunk> chunks;
  std::vector<const KeptField*> sources;
  const bool own_kept = ranks_.attempt("keep", [&] {
    // The server's thread may still read it.
    if (!field || field.use_count() > 1) field = std::make_shared<KeptField>();
    field->keep(passed_.blocks(), plan, {options_.error, options_.relative_error}, kept_range_);
    kept_range_ = field->range();
    chunks = field->pyramid().chunks(field->pyramid().overview());
    sources.assign(chunks.size(), field.get());
    kept_.push_back(field);
  });
  bool all_kept = false;
  if (!ranks_.agree(own_kept, all_kept)) return false;
  if (!all_kept) {
    if (own_kept) kept_.pop_back();
    problem_ = "a rank does not have enough memory for the step; set a smaller max_memory";
    return true;
  }
  const KeptFacts facts{field->range(), field->error()};
  if (!ranks_.gather(&facts, sizeof facts, kept_facts_.data())) return false;
  std::map<Chunk, std::vector<float>> overview;
  if (ranks_.count() > 1 && !gather_chunks(ranks_, sources, chunks, [&](std::size_t number, std::vector<float> values) {
        if (!values.empty()) overview[chunks[number]] = std::move(values);
      }))
    return false;
  if (ranks_.is_first() && !ranks_.attempt("serve", [&] {
        serve_kept(plan, field, data);
        data.served->received = std::move(overview);
      }))
    data.served.reset();
  return true;
}

// Describes the newest kept step for the server, on rank 0.
void InSituSession::serve_kept(const StepPlan& plan, const std::shared_ptr<KeptField>& field, StepData& data) {
  KeptFacts whole;
  for (const KeptFacts& one : kept_facts_) {
    whole.range.low = std::min(whole.range.low, one.range.low);
    whole.range.high = std::max(whole.range.high, one.range.high);
    whole.error = std::max(whole.error, one.error);
  }
  serial_ = plan.serial;
  data.served = std::make_shared<ServedGrid>();
  ServedGrid& served = *data.served;
  served.serial = plan.serial;
  served.pyramid = field->pyramid();
  served.thinning = plan.kept_thinning;
  served.max_error = ErrorBound{options_.error, options_.relative_error}.of(whole.range);
  // Rounds to a quarter of the remaining error, because gradients in viewers would show larger steps.
  served.grid.rounding = std::max(static_cast<float>(served.max_error) - whole.error, 0.0F) / 4;
  served.grid.codes = rounded_scale(whole.range, served.grid.rounding);
  served.grid.field = plan.kept_field.name.data();
  served.grid.unit = plan.kept_field.unit.data();
  for (std::size_t a = 0; a < 3; ++a) {
    const double spacing = plan.grid.spacing[a];
    served.grid.spacing[a] = spacing * plan.kept_thinning;
    served.grid.origin[a] = plan.grid.origin[a] + spacing * static_cast<double>(plan.grid.whole[2 * a]);
    const bool flat = plan.grid.whole[2 * a] == plan.grid.whole[2 * a + 1];
    if (plan.kept_field.of_cells != 0 && !flat) served.grid.origin[a] += spacing / 2;
  }
  if (ranks_.count() == 1)
    served.read = [field](const Chunk& chunk, std::uint32_t first, std::span<float> values) {
      field->read(chunk, first, values);
    };
}

bool InSituSession::send_chunks(std::span<const WantedChunk> wanted) {
  if (wanted.empty()) return true;
  std::array<Chunk, std::tuple_size_v<decltype(StepDecision::chunk)>> chunks;
  std::array<const KeptField*, chunks.size()> sources{};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const WantedChunk& one = wanted[i];
    const auto found = std::ranges::find(kept_, one.serial, [](const auto& field) { return field->serial(); });
    const KeptField* const field = found == kept_.end() ? nullptr : found->get();
    chunks[i] = one.chunk;
    sources[i] = field && field->pyramid().contains(one.chunk) ? field : nullptr;
  }
  const auto all = std::span(sources).first(wanted.size());
  return gather_chunks(
      ranks_, all, std::span(chunks).first(wanted.size()),
      [&](std::size_t number, std::vector<float> values) { publisher_->deliver(wanted[number], std::move(values)); });
}

}  // namespace gs::app::insitu
