#include "app/formats/splats/sog_levels.h"
#include "app/formats/common/ranges.h"
#include "app/formats/common/text_cursor.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace gs::app {
namespace {

using LevelsJson = nlohmann::json;

constexpr std::size_t kMostLevelsBytes = std::size_t{64} << 20;
constexpr std::size_t kJsonBytes = 24;  // maximum memory of a JSON value per byte of its text
constexpr std::size_t kMostLevels = 64, kMostLeaves = 1'000'000, kMostSogFiles = 65536, kMostNesting = 200;
constexpr float kGapPixels = 0.5f;     // smaller gaps between splats are invisible
constexpr float kNearestShare = 0.1f;  // minimum distance of a leaf, relative to its diagonal

/// Problem without a position: the message, and the key in the text that it concerns.
struct KeyProblem {
  std::string message;
  std::string_view key;
};
using MaybeProblem = std::optional<KeyProblem>;

std::optional<std::uint32_t> level_number(const LevelsJson& from, const char* key) {
  const auto found = from.find(key);
  if (found == from.end() || !found->is_number_unsigned()) return std::nullopt;
  constexpr std::uint64_t kMost = std::uint64_t{1} << 31;
  const auto number = found->get<std::uint64_t>();
  return number <= kMost ? std::optional(static_cast<std::uint32_t>(number)) : std::nullopt;
}

/// Returns a box in the axes of VRML97, or an empty box if it is damaged.
Box box_of(const LevelsJson& node) {
  const auto bound = node.find("bound");
  if (bound == node.end() || !bound->is_object()) return {};
  Box box;
  for (const char* key : {"min", "max"}) {
    const auto corner = bound->find(key);
    if (corner == bound->end() || !corner->is_array() || corner->size() != 3) return {};
    glm::dvec3 place(0);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(*corner)[k].is_number()) return {};
      place[static_cast<int>(k)] = (*corner)[k].get<double>();
      if (!(std::abs(place[static_cast<int>(k)]) <= double{kMaxCoordinate})) return {};
    }
    box.add(glm::vec3(place.x, -place.y, -place.z));
  }
  return box;
}

/// Reader of the tree.
class TreeReader {
 public:
  explicit TreeReader(SogLevels& levels) : levels_(levels) {}

  MaybeProblem read(const LevelsJson& root) {
    struct Open {
      const LevelsJson* node;
      Box box;
      std::size_t depth;
    };
    std::vector<Open> open{{&root, {}, 0}};
    while (!open.empty()) {
      const Open here = open.back();
      open.pop_back();
      if (!here.node->is_object() || here.depth > kMostNesting)
        return KeyProblem{"its tree is damaged; expected objects, nested at most 200 deep", "tree"};
      Box box = box_of(*here.node);
      if (box.empty()) box = here.box;
      if (const auto lods = here.node->find("lods"); lods != here.node->end() && lods->is_object()) {
        if (auto problem = read_leaf(*lods, box)) return problem;
        if (levels_.leaves.size() > kMostLeaves)
          return KeyProblem{"its tree has too many parts; expected at most 1000000", "tree"};
      }
      const auto children = here.node->find("children");
      if (children == here.node->end() || !children->is_array()) continue;
      for (auto child = children->rbegin(); child != children->rend(); ++child)
        open.push_back({&*child, box, here.depth + 1});
    }
    return std::nullopt;
  }

 private:
  MaybeProblem read_leaf(const LevelsJson& lods, const Box& box) {
    SogLeaf leaf;
    leaf.box = box;
    for (const auto& [name, one] : lods.items()) {
      SogRun run;
      if (name.empty() || name.size() > 2 || name.find_first_not_of("0123456789") != std::string::npos ||
          !one.is_object() || std::stoul(name) >= kMostLevels)
        return KeyProblem{"a level has the name '" + name.substr(0, 40) + "'; expected a number from 0 to 63", "lods"};
      run.level = static_cast<std::uint32_t>(std::stoul(name));
      const auto file = level_number(one, "file"), first = level_number(one, "offset"),
                 count = level_number(one, "count");
      if (!file || !first || !count || *file >= levels_.files.size())
        return KeyProblem{"level " + name + " of a part has no valid file, offset and count", "lods"};
      run.file = *file;
      run.first = *first;
      run.count = *count;
      if (run.count > 0) leaf.runs.push_back(run);
      levels_.levels = std::max(levels_.levels, std::size_t{run.level} + 1);
    }
    std::ranges::sort(leaf.runs, {}, &SogRun::level);
    if (!leaf.runs.empty()) levels_.leaves.push_back(std::move(leaf));
    return std::nullopt;
  }

  SogLevels& levels_;
};

MaybeProblem read_levels(const LevelsJson& meta, SogLevels& levels) {
  const auto version = meta.find("version");
  if (version != meta.end() && (!version->is_number() || version->get<double>() > 1))
    return KeyProblem{"its version is not supported; expected 1", "version"};
  const auto files = meta.find("filenames");
  if (files == meta.end() || !files->is_array() || files->size() > kMostSogFiles)
    return KeyProblem{"it names no files; expected \"filenames\" with the meta.json of each SOG", "filenames"};
  for (const LevelsJson& file : *files) {
    if (!file.is_string() || !is_inner_path(file.get<std::string>()))
      return KeyProblem{"it names a file outside of its folder", "filenames"};
    levels.files.push_back(file.get<std::string>());
  }
  if (const auto environment = meta.find("environment"); environment != meta.end() && environment->is_string())
    if (auto path = environment->get<std::string>(); is_inner_path(path)) levels.environment = std::move(path);
  const auto tree = meta.find("tree");
  if (tree == meta.end()) return KeyProblem{"it has no tree; expected \"tree\" with the levels of each part", "tree"};
  if (auto problem = TreeReader(levels).read(*tree)) return problem;
  if (levels.leaves.empty())
    return KeyProblem{"its tree has no levels; expected \"lods\" with file, offset and count", "tree"};
  return std::nullopt;
}

SourceLocation location_of(std::string_view text, std::size_t offset) {
  return LineCounter(text.data()).location(text.data() + std::min(offset, text.size()));
}

/// Returns the position of the first occurrence of a key, or of the start of the text.
SourceLocation location_of_key(std::string_view text, std::string_view key) {
  const std::size_t at = text.find("\"" + std::string(key) + "\"");
  return location_of(text, at == std::string_view::npos ? 0 : at);
}

/// Returns the position of the first byte that is invalid JSON.
SourceLocation location_of_damage(std::string_view text) {
  struct Finder : nlohmann::json_sax<LevelsJson> {
    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(std::size_t) override { return true; }
    bool key(string_t&) override { return true; }
    bool end_object() override { return true; }
    bool start_array(std::size_t) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(std::size_t at, const std::string&, const nlohmann::detail::exception&) override {
      offset = at;
      return false;
    }
    std::size_t offset = 0;
  } finder;
  (void)LevelsJson::sax_parse(text.begin(), text.end(), &finder);
  return location_of(text, finder.offset > 0 ? finder.offset - 1 : 0);
}

std::uint8_t next_finer(const SogLeaf& leaf, const std::vector<bool>& unreadable, std::uint8_t run) {
  for (int finer = (run == kNoSogRun ? static_cast<int>(leaf.runs.size()) : int{run}) - 1; finer >= 0; --finer)
    if (!unreadable[leaf.runs[static_cast<std::size_t>(finer)].file]) return static_cast<std::uint8_t>(finer);
  return kNoSogRun;
}

/// Returns the mean distance between the splats of a run, assuming that they cover the largest side of the box.
float gap_of(const SogLeaf& leaf, const SogRun& run) {
  const glm::vec3 size = leaf.box.size();
  const float side = std::max({size.x * size.y, size.y * size.z, size.z * size.x});
  return std::sqrt(side / static_cast<float>(run.count));
}

/// Returns the pixels of one unit of length at a leaf, divided by the error of the view: the maximum over all views. 0
/// means that the leaf is out of view.
float pixels_of(const SogLeaf& leaf, std::span<const qnv::LodView> views, const glm::dvec3& origin) {
  float most = 0;
  if (leaf.box.empty()) return views.empty() ? 0 : std::numeric_limits<float>::max();
  Box box;
  box.add(glm::vec3(glm::dvec3(leaf.box.lower) - origin));
  box.add(glm::vec3(glm::dvec3(leaf.box.upper) - origin));
  const glm::vec3 size = box.size();
  const float diagonal = std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
  for (const qnv::LodView& view : views) {
    if (qnv::outside(box, view)) continue;
    float square = 0;
    for (int k = 0; k < 3; ++k) {
      const float beside = std::max({box.lower[k] - view.eye[k], view.eye[k] - box.upper[k], 0.0f});
      square += beside * beside;
    }
    const float distance = std::max({std::sqrt(square), kNearestShare * diagonal, 1e-20f});
    const float error = view.error_pixels > 0 ? view.error_pixels : 1.0f;
    most = std::max(most, view.pixels / distance / error);
  }
  return most;
}

}  // namespace

bool is_inner_path(const std::string& path) {
  if (path.empty() || path.front() == '/' || path.find_first_of("\\:?#%") != std::string::npos) return false;
  return ("/" + path + "/").find("/../") == std::string::npos;
}

std::variant<SogLevels, SogLevelsProblem> parse_sog_levels(std::span<const std::byte> bytes,
                                                           const WorldBudget& budget) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.size() > kMostLevelsBytes)
    return SogLevelsProblem{"it has " + std::to_string(text.size()) + " bytes; expected at most 64 MiB", {}};
  SogLevels levels;
  levels.share = Share(budget, Resource::files);
  if (!levels.share.grow(kJsonBytes * text.size()))
    return SogLevelsProblem{"it needs " + budget->refusal(Resource::files), {}};
  const LevelsJson meta = LevelsJson::parse(text.begin(), text.end(), nullptr, false);
  if (meta.is_discarded())
    return SogLevelsProblem{"it is damaged; expected JSON with \"filenames\" and \"tree\"", location_of_damage(text)};
  if (!meta.is_object()) return SogLevelsProblem{"it is not a JSON object", location_of(text, 0)};
  if (auto problem = read_levels(meta, levels))
    return SogLevelsProblem{std::move(problem->message), location_of_key(text, problem->key)};
  levels.share.shrink_to(2 * text.size());
  return levels;
}

SogChoice coarsest_sog_runs(const SogLevels& levels, const std::vector<bool>& unreadable) {
  SogChoice choice;
  for (const SogLeaf& leaf : levels.leaves) choice.push_back(next_finer(leaf, unreadable, kNoSogRun));
  return choice;
}

std::uint64_t sog_splats(const SogLevels& levels, const SogChoice& choice) {
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < choice.size(); ++i)
    if (choice[i] != kNoSogRun) total += levels.leaves[i].runs[choice[i]].count;
  return total;
}

SogChoice finest_sog_runs(const SogLevels& levels, const std::vector<bool>& unreadable, std::uint64_t most) {
  SogChoice choice = coarsest_sog_runs(levels, unreadable);
  std::uint64_t total = sog_splats(levels, choice);
  for (std::size_t level = levels.levels; level-- > 0;)
    for (std::size_t i = 0; i < choice.size(); ++i)
      while (choice[i] != kNoSogRun) {
        const SogLeaf& leaf = levels.leaves[i];
        const std::uint8_t finer = next_finer(leaf, unreadable, choice[i]);
        if (finer == kNoSogRun || leaf.runs[finer].level < level) break;
        const std::uint64_t larger = total - leaf.runs[choice[i]].count + leaf.runs[finer].count;
        if (larger > most) break;
        total = larger;
        choice[i] = finer;
      }
  return choice;
}

SogRefinement sog_runs_in_view(const SogLevels& levels, const std::vector<bool>& unreadable,
                               std::span<const qnv::LodView> views, const glm::dvec3& origin, std::uint64_t most) {
  SogRefinement result;
  SogChoice& choice = result.choice;
  choice = coarsest_sog_runs(levels, unreadable);
  std::uint64_t total = sog_splats(levels, choice);
  struct Open {
    float gap;  // pixels
    std::uint32_t leaf;
    float pixels;
    // The widest gap first; among equal gaps, the first leaf.
    bool operator<(const Open& other) const { return gap != other.gap ? gap < other.gap : leaf > other.leaf; }
  };
  std::priority_queue<Open> open;
  const auto add = [&](std::uint32_t i, float pixels) {
    const SogLeaf& leaf = levels.leaves[i];
    const float gap = leaf.box.empty() ? pixels : pixels * gap_of(leaf, leaf.runs[choice[i]]);
    if (gap > kGapPixels) open.push({gap, i, pixels});
  };
  for (std::uint32_t i = 0; i < choice.size(); ++i)
    if (choice[i] != kNoSogRun)
      if (const float pixels = pixels_of(levels.leaves[i], views, origin); pixels > 0) add(i, pixels);
  while (!open.empty()) {
    const Open widest = open.top();
    open.pop();
    const SogLeaf& leaf = levels.leaves[widest.leaf];
    std::uint8_t& run = choice[widest.leaf];
    const std::uint8_t finer = next_finer(leaf, unreadable, run);
    if (finer == kNoSogRun) continue;
    const std::uint64_t larger = total - leaf.runs[run].count + leaf.runs[finer].count;
    if (larger > most) continue;
    total = larger;
    run = finer;
    result.steps.push_back({widest.leaf, finer});
    add(widest.leaf, widest.pixels);
  }
  return result;
}

std::string text_of_sog_parts(const SogParts& parts) {
  nlohmann::ordered_json text;
  text["parts of"] = parts.path;
  text["ranges"] = nlohmann::ordered_json::array();
  for (const SogRun& run : parts.runs) text["ranges"].push_back({run.first, run.count});
  return text.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::optional<SogParts> parse_sog_parts(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kSogPartsMark) || text.size() > kMostLevelsBytes) return std::nullopt;
  const LevelsJson json = LevelsJson::parse(text.begin(), text.end(), nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto path = json.find("parts of"), ranges = json.find("ranges");
  if (path == json.end() || !path->is_string() || ranges == json.end() || !ranges->is_array()) return std::nullopt;
  SogParts parts{path->get<std::string>(), {}};
  for (const LevelsJson& range : *ranges) {
    if (!range.is_array() || range.size() != 2 || !range[0].is_number_unsigned() || !range[1].is_number_unsigned())
      return std::nullopt;
    const auto first = range[0].get<std::uint64_t>(), count = range[1].get<std::uint64_t>();
    constexpr std::uint64_t kMost = std::uint64_t{1} << 31;
    if (first > kMost || count > kMost) return std::nullopt;
    parts.runs.push_back({0, 0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
  }
  return parts;
}

}  // namespace gs::app
