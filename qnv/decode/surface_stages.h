#pragma once

#include "qnv/base/cloud.h"
#include "qnv/displaced/surface.h"
#include "qnv/surface/patch_evaluator.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv {

/// The stages of a displaced surface as they arrive, in any order; clusters that come before their base wait. One
/// thread; safe for untrusted bytes.
class SurfaceStages {
 public:
  struct Count {
    std::size_t vectors = 0, refused = 0, taken = 0;
    bool full = false;  // something was left out because of `most_vectors`
  };

  /// The first stage, as the stream's header has it. `box`: of the stream.
  void begin(std::span<const std::byte> base, const Box& box, std::size_t most_vectors);
  /// The payload of a chunk.
  void add(std::span<const std::byte> payload);
  /// What is shown of all that has come: vertices, and triangles between them. `colored`: they have colours, those
  /// whose have not come that of the cloud. `without`: patches of the main stage that are left out, by number; empty:
  /// none are.
  void append(Cloud& cloud, bool colored, const std::vector<bool>& without = {}) const;
  /// How many vertices that has.
  [[nodiscard]] std::size_t vectors(const std::vector<bool>& without) const;
  /// The stage that is shown in the place of those before: its number, what it is, and at which level; null: none.
  struct Shown {
    int number = 0;
    const displaced::Surface* surface = nullptr;
    int level = 0;
  };
  [[nodiscard]] Shown main() const;
  /// The same for who draws it. Shares with what it gave before what did not change.
  [[nodiscard]] std::shared_ptr<const SurfacePatches> patches();
  [[nodiscard]] const Count& count() const { return count_; }

 private:
  void add_stage(int number, displaced::StageHeader stage);
  /// Forgets the stages whose place another one has taken.
  void drop_stages();
  [[nodiscard]] bool fits(const displaced::Surface& surface) const;
  void recount();
  /// The last stage of which enough has come to take the place of those before; null: none.
  [[nodiscard]] const displaced::Surface* shown() const;
  /// All that are shown together, the main one first.
  [[nodiscard]] std::vector<std::pair<int, const displaced::Surface*>> all_shown() const;
  void append(const displaced::Surface& surface, Cloud& cloud, bool colored, const std::vector<bool>& without) const;

  Box box_;
  std::size_t most_vectors_ = 0, waiting_bytes_ = 0;
  std::uint32_t gone_ = 0;  // a bit a stage whose place another one has taken
  Count count_;
  std::map<int, displaced::Surface> stages_;
  std::map<int, PatchEvaluator> evaluators_;            // of stages that were asked for as patches
  std::multimap<int, std::vector<std::byte>> waiting_;  // by stage
};

}  // namespace gs::qnv
