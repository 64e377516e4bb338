#include "app/insitu/arrays/passed_step.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <variant>

namespace gs::app::insitu {
namespace {

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

}  // namespace

std::optional<std::string> PassedStep::add(const gs_insitu_block& block) {
  if (block.size < sizeof block) return "the size of a block is wrong; set `size` to sizeof";
  auto view = block_view(block);
  if (auto* problem = std::get_if<std::string>(&view)) return std::move(*problem);
  blocks_.push_back(std::move(std::get<BlockView>(view)));
  if (blocks_.back().grid == blocks_.front().grid) return std::nullopt;
  blocks_.pop_back();
  return "two blocks name different grids; expected equal whole_extent, origin and spacing";
}

std::optional<std::string> PassedStep::add(const gs_insitu_cells& cells) {
  if (cells.size < sizeof cells) return "the size of cells is wrong; set `size` to sizeof";
  auto view = cells_view(cells);
  if (auto* problem = std::get_if<std::string>(&view)) return std::move(*problem);
  cells_.push_back(std::move(std::get<CellsView>(view)));
  return std::nullopt;
}

std::optional<std::string> PassedStep::add(const gs_insitu_particles& particles) {
  if (particles.size < sizeof particles) return "the size of particles is wrong; set `size` to sizeof";
  auto view = particles_view(particles);
  if (auto* problem = std::get_if<std::string>(&view)) return std::move(*problem);
  particles_.push_back(std::move(std::get<ParticlesView>(view)));
  return std::nullopt;
}

RankFacts PassedStep::facts(double own_seconds) const {
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
  facts.own_seconds = own_seconds;
  return facts;
}

void PassedStep::clear() {
  blocks_.clear();
  cells_.clear();
  particles_.clear();
}

}  // namespace gs::app::insitu
