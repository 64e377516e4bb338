#include "app/formats/archive/zip_archive.h"
#include "app/formats/splats/sog_levels.h"
#include "app/formats/splats/splat_join.h"
#include "app/formats/splats/splats.h"
#include "app/formats/splats/splats_sog.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// Import of streamed SOG as one geometry: the finest levels that fit into memory, or ranges of one SOG.
namespace gs::app {
namespace {

constexpr std::size_t kMostFailures = 16;  // number of unreadable files after which the import gives up

/// Returns the message for a range that a SOG does not have, or nullopt.
std::optional<std::string> missing_range(const std::string& path, const SplatModel& part, const SogRun& run) {
  if (run.first <= part.size() && run.count <= part.size() - run.first) return std::nullopt;
  return path + " has " + std::to_string(part.size()) + " splats; expected " +
         std::to_string(std::uint64_t{run.first} + run.count);
}

/// Reads the SOG at `path` through `read`. Returns a message on failure.
std::optional<std::string> read_part(const std::string& path, const ReadFile& read, const WorldBudget& budget,
                                     SplatModel& part) {
  if (!read) return path + " is not available";
  const BytesResult meta = read(path);
  if (const auto* problem = std::get_if<std::string>(&meta)) return *problem;
  const std::string folder = path.substr(0, path.rfind('/') + 1);
  const ReadFile beside = [&](const std::string& name) { return read(folder + name); };
  if (auto problem = read_sog_model(std::get<SharedBytes>(meta).bytes, beside, budget, part))
    return path + ": " + *problem;
  return std::nullopt;
}

/// Reader of the chosen levels into one model.
class LevelsReader {
 public:
  LevelsReader(const SogLevels& levels, const ReadFile& read, const WorldBudget& budget)
      : levels_(levels), read_(read), budget_(budget), unreadable_(levels.files.size()) {}

  /// Reads the finest levels that can be read. Returns a message if there are none.
  std::optional<std::string> read(SplatModel& model) {
    std::string last = "no file of its levels can be read";
    for (std::size_t attempt = 0; attempt < kMostFailures; ++attempt) {
      model = {};  // frees the memory of the attempt before, so that the choice may use it
      model.format = "streamed SOG";
      const SogChoice choice = finest_sog_runs(levels_, unreadable_, budget_->left(Resource::vectors) / kSogSplatBytes);
      chosen_count = sog_splats(levels_, choice);
      if (chosen_count == 0) break;
      const auto failed = read_runs(choice, model);
      if (!failed) {
        if (levels_.environment)
          if (const auto problem = append(*levels_.environment, nullptr, model))
            problems.push_back(*problem + "; the environment is left out");
        model.announced = model.size();
        return std::nullopt;
      }
      unreadable_[failed->first] = true;
      last = failed->second;
      problems.push_back(last + "; another level replaces it");
    }
    return last;
  }

  std::vector<std::string> problems;  // messages about omitted files
  std::uint64_t chosen_count = 0;     // splats of the chosen levels

 private:
  /// Returns the file that cannot be read, with a message; nullopt on success.
  std::optional<std::pair<std::size_t, std::string>> read_runs(const SogChoice& choice, SplatModel& model) {
    std::map<std::size_t, std::vector<SogRun>> by_file;
    for (std::size_t i = 0; i < choice.size(); ++i) {
      if (choice[i] == kNoSogRun) continue;
      const SogRun& run = levels_.leaves[i].runs[choice[i]];
      by_file[run.file].push_back(run);
    }
    for (const auto& [file, runs] : by_file)
      if (auto problem = append(levels_.files[file], &runs, model)) return std::pair(file, std::move(*problem));
    return std::nullopt;
  }

  /// Appends runs of a SOG; null means all of its splats.
  std::optional<std::string> append(const std::string& path, const std::vector<SogRun>* runs, SplatModel& model) {
    SplatModel part;
    if (auto problem = read_part(path, read_, budget_, part)) return problem;
    const std::vector<SogRun> all{{0, 0, 0, static_cast<std::uint32_t>(part.size())}};
    for (const SogRun& run : runs ? *runs : all) {
      if (auto problem = missing_range(path, part, run)) return problem;
      if (auto problem = model.append(part, run.first, run.count, budget_)) return problem;
    }
    return std::nullopt;
  }

  const SogLevels& levels_;
  const ReadFile& read_;
  const WorldBudget& budget_;
  std::vector<bool> unreadable_;  // per file
};

ImportedVectors import_levels(const ImportSource& source, std::span<const std::byte> text, const ReadFile& read) {
  const auto parsed = parse_sog_levels(text, source.budget);
  if (const auto* problem = std::get_if<SogLevelsProblem>(&parsed)) {
    source.diagnostics.add(
        {Severity::error, source.path, problem->location, std::string(kSogLevelsName) + ": " + problem->message});
    return std::string();
  }
  const auto& levels = std::get<SogLevels>(parsed);
  SplatModel model;
  LevelsReader reader(levels, read, source.budget);
  if (auto problem = reader.read(model)) return std::string(kSogLevelsName) + ": " + *problem;
  const auto warn = [&](std::string message) {
    source.diagnostics.add({Severity::warning, source.path, {}, std::move(message)});
  };
  for (const std::string& problem : reader.problems) warn(problem);
  std::uint64_t whole = 0;
  for (const SogLeaf& leaf : levels.leaves) whole += leaf.runs.front().count;
  if (reader.chosen_count < whole && reader.problems.empty())
    warn("coarser levels of " + std::to_string(reader.chosen_count) + " splats replace those of " +
         std::to_string(whole) + ", which need " + source.budget->refusal(Resource::vectors));
  return import_result(model);
}

/// Imports ranges of one SOG, each converted separately.
ImportedVectors import_parts(const ImportSource& source, const SogParts& parts) {
  if (!is_inner_path(parts.path)) return parts.path + " is not in the folder of " + std::string(kSogLevelsName);
  SplatModel whole;
  if (auto problem = read_part(parts.path, source.read_file, source.budget, whole)) return *problem;
  qnv::Gaussians all;
  Share share(source.budget, Resource::vectors);
  std::string counts;
  const std::vector<SogRun> every{{0, 0, 0, static_cast<std::uint32_t>(whole.size())}};
  for (const SogRun& run : parts.runs.empty() ? every : parts.runs) {
    if (auto problem = missing_range(parts.path, whole, run)) return *problem;
    SplatModel part;
    part.format = "streamed SOG";
    if (auto problem = part.append(whole, run.first, run.count, source.budget)) return *problem;
    part.announced = part.size();
    const qnv::Gaussians splats = vectors_of_splats(part);
    if (!share.grow(splats.size() * kSplatMemory))
      return parts.path + " needs " + source.budget->refusal(Resource::vectors);
    append_splats(all, splats);
    counts += (counts.empty() ? "" : ",") + std::to_string(splats.size());
  }
  all.description.metadata.emplace_back(kSogPartCounts, counts);
  return all;
}

ImportedVectors import_levels_of(const ImportSource& source) {
  if (const auto parts = parse_sog_parts(source.bytes)) return import_parts(source, *parts);
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
  const BytesResult text = read(std::string(kSogLevelsName));
  if (const auto* problem = std::get_if<std::string>(&text)) return *problem;
  return import_levels(source, std::get<SharedBytes>(text).bytes, read);
}

}  // namespace

bool is_splats_sog_levels(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 4096));
  if (first_name_in_zip(bytes) == kSogLevelsName) return true;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (!text.starts_with('{')) return false;
  const auto has = [&](std::string_view key) { return text.find(key) != std::string_view::npos; };
  return has("\"lodLevels\"") || (has("\"filenames\"") && has("\"tree\"")) || (has("\"lods\"") && has("\"bound\"")) ||
         text.starts_with(kSogPartsMark);
}

Asset read_splats_sog_levels(const ImportSource& source) {
  auto imported = import_levels_of(source);
  if (auto* splats = std::get_if<qnv::Splats>(&imported)) return std::move(*splats);
  if (auto* splats = std::get_if<qnv::Gaussians>(&imported)) return std::move(*splats);
  if (const auto& problem = std::get<std::string>(imported); !problem.empty())
    source.diagnostics.add({Severity::error, source.path, {}, problem});
  return {};
}

}  // namespace gs::app
