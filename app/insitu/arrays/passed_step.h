#pragma once

#include "app/insitu/arrays/grid_parts.h"
#include "app/insitu/arrays/particle_parts.h"
#include "app/insitu/arrays/step_plan.h"
#include "app/insitu/arrays/surface_parts.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app::insitu {

/// Arrays that the caller passed for the open step. The caller keeps them until the step ends.
class PassedStep {
 public:
  /// Adds arrays. If they are invalid, omits them and returns the problem.
  [[nodiscard]] std::optional<std::string> add(const gs_insitu_block& block);
  [[nodiscard]] std::optional<std::string> add(const gs_insitu_cells& cells);
  [[nodiscard]] std::optional<std::string> add(const gs_insitu_particles& particles);
  void clear();

  /// Returns the description of all arrays for rank 0. `own_seconds` is the time of this rank in the library.
  [[nodiscard]] RankFacts facts(double own_seconds) const;
  [[nodiscard]] const std::vector<BlockView>& blocks() const { return blocks_; }
  [[nodiscard]] const std::vector<CellsView>& cells() const { return cells_; }
  [[nodiscard]] const std::vector<ParticlesView>& particles() const { return particles_; }

 private:
  std::vector<BlockView> blocks_;
  std::vector<CellsView> cells_;
  std::vector<ParticlesView> particles_;
};

}  // namespace gs::app::insitu
