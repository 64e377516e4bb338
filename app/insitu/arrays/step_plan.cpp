#include "app/insitu/arrays/step_plan.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace gs::app::insitu {
namespace {

template <std::size_t N>
void set_text(std::array<char, N>& to, std::string_view text) {
  to.fill(0);
  std::copy_n(text.data(), std::min(text.size(), N - 1), to.data());
}

// Returns the facts of the first rank with parts of one kind, or nullptr if no rank has any.
const PartFacts* first_with(std::span<const RankFacts> ranks, PartFacts RankFacts::*kind) {
  for (const RankFacts& rank : ranks)
    if ((rank.*kind).parts > 0) return &(rank.*kind);
  return nullptr;
}

FieldFacts chosen_field(const PartFacts& part, const std::string& name) {
  for (std::size_t i = 0; i < part.fields; ++i)
    if (part.field[i].name.data() == name) return part.field[i];
  return part.fields > 0 ? part.field[0] : FieldFacts{};
}

std::uint64_t grid_bytes(const StepPlan& plan) {
  double all = 0;
  for (std::size_t i = 0; i < plan.grid_fields; ++i) {
    const FieldFacts& field = plan.grid_field[i];
    const auto size = grid_size(plan.grid, field.of_cells != 0, plan.thinning);
    all += static_cast<double>(size[0]) * size[1] * size[2] * field.components *
           static_cast<double>(qnv::size_of(stored_type(field.type)));
  }
  return all < 1e18 ? static_cast<std::uint64_t>(all) : UINT64_MAX;
}

std::uint64_t points_of_grid(const StepPlan& plan) {
  const auto size = grid_size(plan.grid, plan.grid_field[0].of_cells != 0, 1);
  return std::uint64_t{size[0]} * size[1] * std::min(std::uint64_t{size[2]}, UINT64_MAX / size[0] / size[1]);
}

void plan_grid(std::span<const RankFacts> ranks, const PlanWishes& wishes, StepPlan& plan) {
  const RankFacts* first = nullptr;
  for (const RankFacts& rank : ranks) {
    if (rank.blocks.parts == 0) continue;
    if (!first) first = &rank;
    if (!(rank.grid == first->grid)) {
      set_text(plan.problem,
               "the blocks of two ranks name different grids; expected equal whole_extent, origin, spacing");
      return;
    }
  }
  if (!first || first->blocks.fields == 0) return;
  plan.grid = first->grid;
  if (wishes.all_fields) {
    plan.grid_fields = first->blocks.fields;
    plan.grid_field = first->blocks.field;
  } else {
    plan.grid_fields = 1;
    plan.grid_field[0] = chosen_field(first->blocks, wishes.field);
  }
  constexpr std::uint32_t kMaxThinning = 1U << 20;
  if (wishes.keep && plan.grid_field[0].components == 1 && points_of_grid(plan) > kMaxCollectedPoints) {
    plan.keeps = 1;
    plan.serial = wishes.serial;
    plan.kept_field = plan.grid_field[0];
    plan.grid_fields = 0;
    std::uint64_t most = 0;
    for (const RankFacts& rank : ranks) most = std::max(most, rank.blocks.count);
    // Thinning does not shrink flat axes.
    double part = 1;
    for (const std::uint32_t points : grid_size(plan.grid, plan.kept_field.of_cells != 0, 1))
      if (points > 1) part /= 2;
    double bytes = static_cast<double>(most) * wishes.kept_bytes * kKeptSteps;
    for (; bytes > static_cast<double>(wishes.max_memory) && plan.kept_thinning < kMaxThinning; bytes *= part)
      plan.kept_thinning *= 2;
    return;
  }
  const bool small = wishes.keep && points_of_grid(plan) <= kMaxCollectedPoints;
  const std::uint64_t most = small ? wishes.max_memory : std::min(wishes.max_memory, wishes.max_collected);
  while (grid_bytes(plan) > most && plan.thinning < kMaxThinning) plan.thinning *= 2;
}

}  // namespace

FieldFacts facts_of(const FieldView& view) {
  FieldFacts facts;
  set_text(facts.name, view.name);
  set_text(facts.unit, view.unit);
  facts.type = view.type;
  facts.of_cells = view.of_cells ? 1 : 0;
  facts.components = view.components;
  return facts;
}

const FieldView* find_field(std::span<const FieldView> fields, const FieldFacts& facts) {
  for (const FieldView& field : fields)
    if (field.name == facts.name.data() && field.of_cells == (facts.of_cells != 0) &&
        stored_type(field.type) == stored_type(facts.type) && field.components == facts.components)
      return &field;
  return nullptr;
}

std::array<std::uint32_t, 3> grid_size(const GridFacts& grid, bool of_cells, std::uint32_t thinning) {
  std::array<std::uint32_t, 3> size{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t points = grid.whole[2 * a + 1] - grid.whole[2 * a] + 1;
    const std::int64_t all = of_cells ? std::max<std::int64_t>(points - 1, 1) : points;
    size[a] = static_cast<std::uint32_t>((all - 1) / thinning + 1);
  }
  return size;
}

StepPlan plan_step(std::span<const RankFacts> ranks, const PlanWishes& wishes) {
  StepPlan plan;
  plan.max_memory = wishes.max_records;
  plan_grid(ranks, wishes, plan);
  std::array<double, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  const auto widen = [&](const PartFacts& part) {
    if (part.count == 0) return;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], part.low[a]);
      high[a] = std::max(high[a], part.high[a]);
    }
  };
  for (const RankFacts& rank : ranks) {
    widen(rank.cells);
    widen(rank.particles);
    plan.radius = std::max(plan.radius, rank.particles.radius);
  }
  for (std::size_t a = 0; a < 3; ++a)
    if (low[a] <= high[a]) plan.origin[a] = static_cast<double>(static_cast<float>((low[a] + high[a]) / 2));
  if (const PartFacts* const cells = first_with(ranks, &RankFacts::cells)) {
    plan.has_cells = 1;
    plan.cell_field = chosen_field(*cells, wishes.field);
  }
  if (const PartFacts* const particles = first_with(ranks, &RankFacts::particles)) {
    plan.has_particles = 1;
    std::uint64_t count = 0;
    for (const RankFacts& rank : ranks) count += std::min(rank.particles.count, UINT64_MAX / 64 / ranks.size());
    // Each rank rounds its number of particles up; leave room for one more per rank.
    const std::uint64_t most = wishes.max_records / sizeof(ParticlePoint);
    const std::uint64_t room = most > ranks.size() ? most - ranks.size() : 1;
    plan.particle_stride =
        static_cast<std::uint32_t>(std::clamp<std::uint64_t>((count + room - 1) / room, 1, UINT32_MAX));
    plan.particle_field = chosen_field(*particles, wishes.field);
  }
  return plan;
}

}  // namespace gs::app::insitu
