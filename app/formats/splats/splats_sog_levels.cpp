#include "app/formats/archive/zip_archive.h"
#include "app/formats/splats/splats.h"
#include "app/formats/splats/splats_sog.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// Import of streamed SOG (PlayCanvas): lod-meta.json has a tree of boxes. Each leaf has one part of the scene at
// several levels of detail. A level is a range of splats of a SOG in a folder beside lod-meta.json.
namespace gs::app {
namespace {

using LevelsJson = nlohmann::json;

constexpr std::string_view kLevelsName = "lod-meta.json";
constexpr std::size_t kMostLevelsBytes = std::size_t{64} << 20;
constexpr std::size_t kMostLevels = 64, kMostLeaves = 1'000'000, kMostSogFiles = 65536, kMostNesting = 200;
constexpr std::size_t kMostFailures = 16;  // number of unreadable files after which the import gives up
// Memory in bytes for one splat while a scene is read: two copies, with harmonics of degree 3.
constexpr std::uint64_t kLevelSplatBytes = 2 * (kSplatMemory + 2 * sizeof(glm::vec3) * 15);

/// Splats of one level of a leaf.
struct SogRun {
  std::size_t level = 0, file = 0, first = 0, count = 0;
};
using SogLeaf = std::vector<SogRun>;  // finest first

/// Content of lod-meta.json.
struct SogLevels {
  std::vector<std::string> files;  // paths of meta.json of each SOG
  std::optional<std::string> environment;
  std::vector<SogLeaf> leaves;
  std::size_t levels = 0;
};

/// Returns true for a path below the folder of lod-meta.json.
bool is_inner_path(const std::string& path) {
  if (path.empty() || path.front() == '/' || path.find_first_of("\\:?#%") != std::string::npos) return false;
  return ("/" + path + "/").find("/../") == std::string::npos;
}

std::optional<std::size_t> level_number(const LevelsJson& from, const char* key) {
  const auto found = from.find(key);
  if (found == from.end() || !found->is_number_unsigned()) return std::nullopt;
  constexpr std::uint64_t kMost = std::uint64_t{1} << 31;
  const auto number = found->get<std::uint64_t>();
  return number <= kMost ? std::optional(static_cast<std::size_t>(number)) : std::nullopt;
}

std::optional<std::string> read_leaf(const LevelsJson& lods, SogLevels& levels) {
  SogLeaf leaf;
  for (const auto& [name, one] : lods.items()) {
    SogRun run;
    if (name.empty() || name.size() > 2 || name.find_first_not_of("0123456789") != std::string::npos ||
        !one.is_object())
      return "a level has the name '" + name.substr(0, 40) + "'; expected a number";
    run.level = static_cast<std::size_t>(std::stoul(name));
    const auto file = level_number(one, "file"), first = level_number(one, "offset"),
               count = level_number(one, "count");
    if (!file || !first || !count || *file >= levels.files.size())
      return "level " + name + " of a part has no valid file, offset and count";
    run.file = *file;
    run.first = *first;
    run.count = *count;
    if (run.count > 0) leaf.push_back(run);
    levels.levels = std::max(levels.levels, run.level + 1);
  }
  std::ranges::sort(leaf, {}, &SogRun::level);
  if (!leaf.empty()) levels.leaves.push_back(std::move(leaf));
  return std::nullopt;
}

std::optional<std::string> read_tree(const LevelsJson& root, SogLevels& levels) {
  std::vector<std::pair<const LevelsJson*, std::size_t>> open{{&root, 0}};
  while (!open.empty()) {
    const auto [node, depth] = open.back();
    open.pop_back();
    if (!node->is_object() || depth > kMostNesting) return "its tree is damaged";
    if (const auto lods = node->find("lods"); lods != node->end() && lods->is_object()) {
      if (auto problem = read_leaf(*lods, levels)) return problem;
      if (levels.leaves.size() > kMostLeaves) return "its tree has too many parts";
    }
    const auto children = node->find("children");
    if (children == node->end() || !children->is_array()) continue;
    for (auto child = children->rbegin(); child != children->rend(); ++child) open.emplace_back(&*child, depth + 1);
  }
  return std::nullopt;
}

std::variant<SogLevels, std::string> parse_levels(std::span<const std::byte> text) {
  if (text.size() > kMostLevelsBytes)
    return "it has " + std::to_string(text.size()) + " bytes; expected at most 64 MiB";
  const auto* const characters = reinterpret_cast<const char*>(text.data());
  const LevelsJson meta = LevelsJson::parse(characters, characters + text.size(), nullptr, false);
  if (!meta.is_object()) return "it is not a JSON object";
  const auto version = meta.find("version");
  if (version != meta.end() && (!version->is_number() || version->get<double>() > 1))
    return "its version is not known; expected 1";
  SogLevels levels;
  const auto files = meta.find("filenames");
  if (files == meta.end() || !files->is_array() || files->size() > kMostSogFiles) return "it names no files";
  for (const LevelsJson& file : *files) {
    if (!file.is_string() || !is_inner_path(file.get<std::string>()))
      return "it names a file that is not in its folder or below";
    levels.files.push_back(file.get<std::string>());
  }
  if (const auto environment = meta.find("environment"); environment != meta.end() && environment->is_string())
    if (auto path = environment->get<std::string>(); is_inner_path(path)) levels.environment = std::move(path);
  const auto tree = meta.find("tree");
  if (tree == meta.end()) return "it has no tree";
  if (auto problem = read_tree(*tree, levels)) return std::move(*problem);
  if (levels.leaves.empty()) return "its tree has no splats";
  if (levels.levels > kMostLevels) return "it has too many levels";
  return levels;
}

/// Reader of the chosen levels into one model.
class LevelsReader {
 public:
  LevelsReader(const SogLevels& levels, const ReadFile& read, const WorldBudget& budget)
      : levels_(levels), read_(read), budget_(budget), missing_(levels.files.size()) {}

  /// Reads the finest levels that can be read. Returns a message if there are none.
  std::optional<std::string> read(SplatModel& model) {
    std::string last = "no file of its levels can be read";
    for (std::size_t attempt = 0; attempt < kMostFailures; ++attempt) {
      model = {};  // frees the memory of the attempt before, so that the choice may use it
      model.format = "streamed SOG";
      const auto chosen = choose();
      if (chosen.empty()) break;
      const auto failed = read_runs(chosen, model);
      if (!failed) {
        if (levels_.environment)
          if (const auto problem = append(*levels_.environment, nullptr, model))
            problems.push_back(*problem + "; the environment is left out");
        model.announced = model.size();
        return std::nullopt;
      }
      missing_[failed->first] = true;
      last = failed->second;
      problems.push_back(last + "; another level replaces it");
    }
    return last;
  }

  std::vector<std::string> problems;        // files that were left out, as messages
  std::size_t chosen_count = 0, whole = 0;  // splats of the chosen and of the finest levels

 private:
  /// Returns the chosen run of each leaf that has a readable run.
  std::vector<SogRun> choose() {
    const std::uint64_t most = budget_->left(Resource::vectors) / kLevelSplatBytes;
    std::vector<SogLeaf> here;
    whole = 0;
    for (const SogLeaf& leaf : levels_.leaves) {
      SogLeaf kept;
      for (const SogRun& run : leaf)
        if (!missing_[run.file]) kept.push_back(run);
      whole += leaf.front().count;
      if (!kept.empty()) here.push_back(std::move(kept));
    }
    // Starts with the coarsest levels, and refines all parts level by level while they fit into memory.
    std::vector<std::size_t> at;
    std::uint64_t total = 0;
    for (const SogLeaf& leaf : here) {
      at.push_back(leaf.size() - 1);
      total += leaf.back().count;
    }
    for (std::size_t level = levels_.levels; level-- > 0;)
      for (std::size_t i = 0; i < here.size(); ++i)
        while (at[i] > 0 && here[i][at[i] - 1].level >= level) {
          const std::uint64_t finer = total - here[i][at[i]].count + here[i][at[i] - 1].count;
          if (finer > most) break;
          total = finer;
          --at[i];
        }
    std::vector<SogRun> chosen;
    for (std::size_t i = 0; i < here.size(); ++i) chosen.push_back(here[i][at[i]]);
    chosen_count = static_cast<std::size_t>(total);
    return chosen;
  }

  /// Returns the file that cannot be read, with a message; nullopt on success.
  std::optional<std::pair<std::size_t, std::string>> read_runs(const std::vector<SogRun>& chosen, SplatModel& model) {
    std::map<std::size_t, std::vector<SogRun>> by_file;
    for (const SogRun& run : chosen) by_file[run.file].push_back(run);
    for (const auto& [file, runs] : by_file)
      if (auto problem = append(levels_.files[file], &runs, model)) return std::pair(file, std::move(*problem));
    return std::nullopt;
  }

  /// Appends runs of a SOG; null means all of its splats.
  std::optional<std::string> append(const std::string& path, const std::vector<SogRun>* runs, SplatModel& model) {
    if (!read_) return path + " is not available";
    const BytesResult meta = read_(path);
    if (const auto* problem = std::get_if<std::string>(&meta)) return *problem;
    const std::string folder = path.substr(0, path.rfind('/') + 1);
    const ReadFile beside = [&](const std::string& name) { return read_(folder + name); };
    SplatModel part;
    if (auto problem = read_sog_model(std::get<SharedBytes>(meta).bytes, beside, budget_, part))
      return path + ": " + *problem;
    const std::vector<SogRun> all{{0, 0, 0, part.size()}};
    for (const SogRun& run : runs ? *runs : all) {
      if (run.first > part.size() || run.count > part.size() - run.first)
        return path + " has " + std::to_string(part.size()) + " splats; expected " +
               std::to_string(run.first + run.count);
      if (auto problem = append(part, run, model)) return problem;
    }
    return std::nullopt;
  }

  std::optional<std::string> append(const SplatModel& part, const SogRun& run, SplatModel& model) {
    if (model.size() == 0) model.set_degree(part.degree);
    if (auto problem = model.draw(budget_, run.count)) return problem;
    const std::size_t first = model.size();
    model.resize(first + run.count);
    model.antialiased = part.antialiased;
    const std::size_t per = qnv::harmonic_count(model.degree), held = qnv::harmonic_count(part.degree);
    for (std::size_t i = 0; i < run.count; ++i) {
      const std::size_t from = run.first + i, to = first + i;
      model.positions[to] = part.positions[from];
      model.scales[to] = part.scales[from];
      model.rotations[to] = part.rotations[from];
      model.opacities[to] = part.opacities[from];
      model.dc[to] = part.dc[from];
      for (std::size_t k = 0; k < std::min(per, held); ++k)
        model.coefficient(to, k) = part.coefficients[from * held + k];
    }
    return std::nullopt;
  }

  const SogLevels& levels_;
  const ReadFile& read_;
  const WorldBudget& budget_;
  std::vector<bool> missing_;  // per file
};

ImportedVectors import_levels(const ImportSource& source, std::span<const std::byte> text, const ReadFile& read) {
  const auto parsed = parse_levels(text);
  if (const auto* problem = std::get_if<std::string>(&parsed)) return std::string(kLevelsName) + ": " + *problem;
  SplatModel model;
  LevelsReader reader(std::get<SogLevels>(parsed), read, source.budget);
  if (auto problem = reader.read(model)) return std::string(kLevelsName) + ": " + *problem;
  const auto warn = [&](std::string message) {
    source.diagnostics.add({Severity::warning, source.path, {}, std::move(message)});
  };
  for (const std::string& problem : reader.problems) warn(problem);
  if (reader.chosen_count < reader.whole && reader.problems.empty())
    warn("coarser levels of " + std::to_string(reader.chosen_count) + " splats replace those of " +
         std::to_string(reader.whole) + ", which need " + source.budget->refusal(Resource::vectors));
  return import_result(model);
}

ImportedVectors import_levels_of(const ImportSource& source) {
  if (!is_zip(source.bytes)) return import_levels(source, source.bytes, source.read_file);
  auto opened = ZipArchive::open(source.bytes);
  if (auto* problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  const ZipArchive& archive = std::get<ZipArchive>(opened);
  const ReadFile read = [&](const std::string& path) -> BytesResult {
    auto unpacked = archive.read_path(path, source.budget);
    if (!unpacked) return path + " is missing";
    if (auto* problem = std::get_if<std::string>(&*unpacked)) return std::move(*problem);
    return shared_bytes(std::move(std::get<std::vector<std::byte>>(*unpacked)));
  };
  const BytesResult text = read(std::string(kLevelsName));
  if (const auto* problem = std::get_if<std::string>(&text)) return *problem;
  return import_levels(source, std::get<SharedBytes>(text).bytes, read);
}

}  // namespace

bool is_splats_sog_levels(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 4096));
  if (first_name_in_zip(bytes) == kLevelsName) return true;
  return text.starts_with('{') && text.find("\"lodLevels\"") != std::string_view::npos &&
         (text.find("\"filenames\"") != std::string_view::npos || text.find("\"tree\"") != std::string_view::npos);
}

Asset read_splats_sog_levels(const ImportSource& source) {
  auto imported = import_levels_of(source);
  if (auto* splats = std::get_if<qnv::Splats>(&imported)) return std::move(*splats);
  if (auto* splats = std::get_if<qnv::Gaussians>(&imported)) return std::move(*splats);
  source.diagnostics.add({Severity::error, source.path, {}, std::get<std::string>(imported)});
  return {};
}

}  // namespace gs::app
