#include "app/insitu/arrays/kept_field.h"
#include "tests/app/insitu/insitu_helpers.h"
#include "tests/app/insitu/thread_ranks.h"

#include <cmath>
#include <map>

namespace gs::app::insitu {
namespace kept_field_test {

using namespace test;

/// Blocks of one rank with a part of a smooth grid.
struct RankBlocks {
  RankBlocks(const SmoothGrid& grid, std::int64_t first, std::int64_t end, std::int64_t ghosts = 0) {
    gs_insitu_field field;
    const gs_insitu_block block = grid.block(first, end, values, field, ghosts);
    auto view = block_view(block);
    REQUIRE(std::holds_alternative<BlockView>(view));
    blocks.push_back(std::move(std::get<BlockView>(view)));
    plan.grid = blocks.front().grid;
    plan.keeps = 1;
    plan.serial = 5;
    plan.kept_field = facts_of(blocks.front().fields.front());
  }
  std::vector<double> values;
  std::vector<BlockView> blocks;
  StepPlan plan;
};

// Returns the largest error of the values of a chunk of a pyramid over the whole grid.
double largest_error(const SmoothGrid& grid, const Pyramid& pyramid, const Chunk& chunk,
                     const std::vector<float>& values, std::int64_t thinning = 1) {
  const GridIndex shape = pyramid.chunk_shape(chunk.level);
  const std::int64_t step = thinning << chunk.level;
  double most = 0;
  std::size_t i = 0;
  REQUIRE(values.size() == pyramid.chunk_points(chunk.level));
  for (std::uint32_t z = 0; z < shape[2]; ++z)
    for (std::uint32_t y = 0; y < shape[1]; ++y)
      for (std::uint32_t x = 0; x < shape[0]; ++x, ++i) {
        const GridIndex at{chunk.index[0] * shape[0] + x, chunk.index[1] * shape[1] + y, chunk.index[2] * shape[2] + z};
        bool inside = true;
        for (std::size_t a = 0; a < 3; ++a) inside = inside && at[a] < pyramid.size(chunk.level)[a];
        const auto value = static_cast<double>(values[i]);
        if (!inside)
          most = std::isnan(value) ? most : 1e9;
        else if (!(std::abs(value - grid.at(at[0] * step, at[1] * step, at[2] * step)) <= most))
          most = std::abs(value - grid.at(at[0] * step, at[1] * step, at[2] * step));
      }
  return most;
}

TEST_CASE("in situ kept field: chunks of all levels have the values of the grid") {
  const SmoothGrid grid(100);
  const RankBlocks rank(grid, 0, 100);
  KeptField field;
  field.keep(rank.blocks, rank.plan, {0, 0.001}, {});
  CHECK(field.bytes() == 100 * 100 * 100 * 2);
  CHECK(field.serial() == 5);
  const double bound = 0.001 * static_cast<double>(field.range().high - field.range().low);
  CHECK(static_cast<double>(field.error()) <= bound / 4);
  std::vector<float> values;
  for (const Chunk& chunk : {Chunk{0, {0, 0, 0}}, Chunk{0, {1, 1, 1}}, Chunk{0, {1, 0, 1}}, Chunk{1, {0, 0, 0}}}) {
    values.resize(field.pyramid().chunk_points(chunk.level));
    field.read(chunk, 0, values);
    CHECK(largest_error(grid, field.pyramid(), chunk, values) <= static_cast<double>(field.error()) * 1.01);
  }
}

TEST_CASE("in situ kept field: a wrong expectation of the range changes nothing") {
  const SmoothGrid grid(20);
  const RankBlocks rank(grid, 0, 20);
  for (const FiniteRange& expected :
       {FiniteRange{}, FiniteRange{0, 1}, FiniteRange{-1e6f, 1e6f}, FiniteRange{-3, 15}}) {
    KeptField field;
    field.keep(rank.blocks, rank.plan, {0, 0.001}, expected);
    std::vector<float> values;
    values.resize(field.pyramid().chunk_points(0));
    field.read({0, {0, 0, 0}}, 0, values);
    CHECK(largest_error(grid, field.pyramid(), {}, values) <= 0.001 * 18 / 4);
  }
}

TEST_CASE("in situ kept field: small errors need floats") {
  const SmoothGrid grid(20);
  const RankBlocks rank(grid, 0, 20);
  KeptField field;
  field.keep(rank.blocks, rank.plan, {1e-6, 0}, {});
  CHECK(field.error() == 0);
  CHECK(field.bytes() == 20 * 20 * 20 * 4);
  std::vector<float> values;
  values.resize(field.pyramid().chunk_points(0));
  field.read({0, {0, 0, 0}}, 0, values);
  CHECK(largest_error(grid, field.pyramid(), {}, values) <= 1e-6);
}

TEST_CASE("in situ kept field: the ranks send the chunks that rank 0 names") {
  const SmoothGrid grid(90);
  for (const int count : {2, 3}) {
    INFO(count << " ranks");
    std::map<std::size_t, std::vector<float>> chunks;
    Pyramid pyramid;
    float error = 0;
    const std::vector<Chunk> wanted{{0, {0, 1, 0}}, {1, {0, 0, 0}}, {0, {1, 1, 1}}};
    ThreadRanks::run(count, [&](int number, const gs_insitu_communicator& table) {
      Ranks ranks(&table);
      const RankBlocks rank(grid, 90 * number / count, 90 * (number + 1) / count, 1);
      KeptField field;
      field.keep(rank.blocks, rank.plan, {0, number == 1 ? 1e-6 : 0.001}, {});  // rank 1 sends floats
      const std::vector<const KeptField*> kept{&field, &field, nullptr};
      const bool sound = gather_chunks(
          ranks, kept, wanted, [&](std::size_t i, std::vector<float> values) { chunks[i] = std::move(values); });
      if (!sound || number != 0) return;
      pyramid = field.pyramid();
      error = field.error();
    });
    REQUIRE(chunks.size() == 3);
    CHECK(chunks[2].empty());
    CHECK(error > 0);
    for (const std::size_t i : {0UL, 1UL}) CHECK(largest_error(grid, pyramid, wanted[i], chunks[i]) < 0.002);
  }
}

TEST_CASE("in situ kept field: a large grid is kept, and thinned if the ranks lack memory") {
  RankFacts facts;
  facts.grid.whole = {0, 127, 0, 127, 0, 127};
  facts.blocks.parts = facts.blocks.fields = 1;
  facts.blocks.count = 128 * 128 * 128;
  facts.blocks.field[0].type = GS_INSITU_FLOAT64;
  PlanWishes wishes;
  wishes.keep = true;
  wishes.max_memory = 20'000'000;
  const std::vector<RankFacts> all(1, facts);
  CHECK(plan_step(all, wishes).keeps == 1);
  CHECK(plan_step(all, wishes).grid_fields == 0);
  CHECK(plan_step(all, wishes).kept_thinning == 1);
  wishes.max_memory = 2'000'000;
  CHECK(plan_step(all, wishes).kept_thinning == 2);
  wishes.keep = false;
  CHECK(plan_step(all, wishes).keeps == 0);
  CHECK(plan_step(all, wishes).grid_fields == 1);
  facts.grid.whole = {0, 31, 0, 31, 0, 31};
  wishes.keep = true;
  wishes.max_collected = 1000;
  CHECK(plan_step(std::vector<RankFacts>(1, facts), wishes).keeps == 0);
  CHECK(plan_step(std::vector<RankFacts>(1, facts), wishes).thinning == 1);
}

TEST_CASE("in situ plan: vectors are not kept, and are thinned so that the share permits them") {
  RankFacts facts;
  facts.grid.whole = {0, 127, 0, 127, 0, 127};
  facts.blocks.parts = facts.blocks.fields = 1;
  facts.blocks.field[0].type = GS_INSITU_FLOAT32;
  facts.blocks.field[0].components = 3;
  PlanWishes wishes;
  wishes.keep = true;
  wishes.max_memory = 100'000'000;
  const std::vector<RankFacts> all(1, facts);
  CHECK(plan_step(all, wishes).keeps == 0);
  CHECK(plan_step(all, wishes).thinning == 1);
  wishes.max_collected = 4'000'000;
  CHECK(plan_step(all, wishes).thinning == 2);
}

}  // namespace kept_field_test
}  // namespace gs::app::insitu
