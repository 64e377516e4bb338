#pragma once

#include "base/box.h"
#include "base/budget.h"
#include "base/diagnostic.h"
#include "qnv/codecs/shared/lod_view.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Streamed SOG (PlayCanvas): lod-meta.json has a tree of boxes. Each leaf has one part of the scene at several levels
/// of detail. A level is a range of splats of a SOG in a folder beside lod-meta.json.
namespace gs::app {

inline constexpr std::string_view kSogLevelsName = "lod-meta.json";
/// Memory in bytes for one splat with harmonics of degree 3 while levels are read and shown. Counts three copies: as
/// read, as converted and as drawn.
inline constexpr std::uint64_t kSogSplatBytes = 1100;

/// Range of splats of a SOG: one level of a leaf.
struct SogRun {
  std::uint32_t level = 0, file = 0, first = 0, count = 0;  // level 0 is the finest
  friend bool operator==(const SogRun&, const SogRun&) = default;
};

/// Part of a scene, with at least one run.
struct SogLeaf {
  Box box;                   // in the axes of VRML97; empty means unknown
  std::vector<SogRun> runs;  // the finest first
};

/// Content of lod-meta.json.
struct SogLevels {
  std::vector<std::string> files;          // paths of the meta.json of each SOG
  std::optional<std::string> environment;  // path of the meta.json of splats without levels
  std::vector<SogLeaf> leaves;
  std::size_t levels = 0;
  Share share;  // memory of the lists
};

/// Problem of lod-meta.json.
struct SogLevelsProblem {
  std::string message;
  SourceLocation location;
};

/// Parses lod-meta.json. Safe for untrusted text: charges all memory to `budget`.
[[nodiscard]] std::variant<SogLevels, SogLevelsProblem> parse_sog_levels(std::span<const std::byte> text,
                                                                         const WorldBudget& budget);
/// Returns true if a path stays below the folder of the file that contains it.
[[nodiscard]] bool is_inner_path(const std::string& path);

/// Index of the chosen run of each leaf; kNoSogRun if no file of the leaf can be read.
using SogChoice = std::vector<std::uint8_t>;
inline constexpr std::uint8_t kNoSogRun = 255;
/// Returns the coarsest runs. `unreadable` has an entry per file, and one more for the environment.
[[nodiscard]] SogChoice coarsest_sog_runs(const SogLevels& levels, const std::vector<bool>& unreadable);
/// Returns the finest runs with at most `most` splats. Refines all leaves level by level while they fit.
[[nodiscard]] SogChoice finest_sog_runs(const SogLevels& levels, const std::vector<bool>& unreadable,
                                        std::uint64_t most);
/// Returns the number of splats of a choice.
[[nodiscard]] std::uint64_t sog_splats(const SogLevels& levels, const SogChoice& choice);

/// Run of a leaf.
struct SogStep {
  std::uint32_t leaf = 0;
  std::uint8_t run = 0;
};
/// Runs for views: the choice, and the steps from the coarsest runs to it, most important first.
struct SogRefinement {
  SogChoice choice;
  std::vector<SogStep> steps;
};
/// Returns the runs for views. The positions of the views are relative to `origin`. Refines each leaf in view until the
/// gaps between its splats are below half a pixel (times the error of the view). The leaf with the widest gaps comes
/// first. Leaves out of view keep the coarsest run. The choice has at most `most` splats, unless the
/// coarsest runs have more.
[[nodiscard]] SogRefinement sog_runs_in_view(const SogLevels& levels, const std::vector<bool>& unreadable,
                                             std::span<const qnv::LodView> views, const glm::dvec3& origin,
                                             std::uint64_t most);

/// Ranges of one SOG, for read_splats_sog_levels() in another process.
struct SogParts {
  std::string path;          // of its meta.json
  std::vector<SogRun> runs;  // empty means all splats, as one range
};
/// Writes ranges as a text that read_splats_sog_levels() reads instead of lod-meta.json. The result then has
/// kSogPartCounts in its metadata: the number of splats of each range, separated by commas.
[[nodiscard]] std::string text_of_sog_parts(const SogParts& parts);
/// Parses a text of text_of_sog_parts(). Returns nullopt for other texts.
[[nodiscard]] std::optional<SogParts> parse_sog_parts(std::span<const std::byte> text);
inline constexpr std::string_view kSogPartCounts = "splats of ranges";
/// First bytes of a text of text_of_sog_parts().
inline constexpr std::string_view kSogPartsMark = "{\"parts of\":";

}  // namespace gs::app
