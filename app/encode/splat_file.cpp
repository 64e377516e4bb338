#include "app/encode/splat_file.h"

#include "app/formats/common/transfer.h"
#include "app/formats/content_types.h"
#include "app/formats/splats/splats.h"
#include "base/gzip.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

/// Splats of a file, and the callback that releases them from memory.
struct FileRuns {
  SplatRows rows;
  std::size_t bytes = 0;  // size of the file
  PutAside put_aside;

  [[nodiscard]] std::uint64_t runs() const { return (rows.count + kSplatRun - 1) / kSplatRun; }
  /// Calls take(splats) for the splats of a run. Returns false if the call returns false, or if reading fails.
  bool read(std::uint64_t run, const std::function<bool(const qnv::Gaussians&)>& take) const {
    const std::size_t first = static_cast<std::size_t>(run) * kSplatRun,
                      count = std::min(kSplatRun, rows.count - first);
    SplatModel model;
    if (rows.read(first, count, own_budget(), model)) return false;
    const qnv::Gaussians splats = vectors_of_splats(model);
    if (!splats.empty() && !take(splats)) return false;
    if (put_aside) put_aside(std::min(bytes, rows.start + (first + count) * rows.row_bytes));
    return true;
  }
};

/// Merges the metadata of a piece into that of the file: adds counts, and keeps the first of other texts.
void add_piece(std::vector<std::pair<std::string, std::string>>& all,
               const std::vector<std::pair<std::string, std::string>>& piece) {
  for (const auto& [key, value] : piece) {
    const auto same = std::ranges::find(all, key, [](const auto& pair) { return pair.first; });
    std::uint64_t more = 0, before = 0;
    const auto number = std::from_chars(value.data(), value.data() + value.size(), more);
    const bool counts = number.ec == std::errc() && number.ptr == value.data() + value.size();
    if (same == all.end())
      all.emplace_back(key, value);
    else if (counts &&
             std::from_chars(same->second.data(), same->second.data() + same->second.size(), before).ec == std::errc())
      same->second = std::to_string(before + more);
  }
}

/// Opens a file with more than `more_than` splats. Returns nullopt for other files.
std::optional<FileRuns> runs_of(std::string_view path, std::span<const std::byte> bytes, std::size_t more_than,
                                const PutAside& put_aside) {
  if (is_gzip(bytes)) return std::nullopt;
  const ContentType& type = content_type_of(path, first_bytes(bytes));
  if (!type.open_rows) return std::nullopt;
  auto opened = type.open_rows(bytes, own_budget());
  auto* const rows = std::get_if<SplatRows>(&opened);
  if (!rows || rows->count <= more_than) return std::nullopt;
  return FileRuns{std::move(*rows), bytes.size(), put_aside};
}

/// Surveys the runs of a rank. Returns nullopt if a run cannot be read.
std::optional<SplatSurvey> own_survey(const FileRuns& file, const qnv::RankShare& runs) {
  SplatSurvey survey;
  for (std::uint64_t run = runs.first; run < runs.end; ++run) {
    SplatSurvey::Run& here = survey.runs.emplace_back();
    const bool good = file.read(run, [&](const qnv::Gaussians& splats) {
      survey.degree = splats.degree;
      survey.antialiased = splats.antialiased;
      here.splats = splats.size();
      const qnv::Description& own = splats.description;
      survey.two_sided = own.two_sided;
      here.area = own.total;
      survey.box.add(own.origin + glm::dvec3(own.box.lower));
      survey.box.add(own.origin + glm::dvec3(own.box.upper));
      add_piece(survey.metadata, own.metadata);
      return true;
    });
    if (!good) return std::nullopt;
  }
  return survey;
}

std::vector<std::byte> bytes_of(const SplatSurvey& survey) {
  TransferWriter to;
  to.list(survey.runs);
  to.value(survey.degree);
  to.value<std::uint8_t>(survey.antialiased);
  to.value<std::uint8_t>(survey.two_sided);
  to.value(survey.box);
  to.value<std::uint64_t>(survey.metadata.size());
  for (const auto& [key, value] : survey.metadata) {
    to.text(key);
    to.text(value);
  }
  return to.take();
}

/// Adds the survey of the next rank, which it reads from `from`.
void add_survey(SplatSurvey& all, TransferReader& from) {
  const auto runs = from.list<SplatSurvey::Run>();
  all.runs.insert(all.runs.end(), runs.begin(), runs.end());
  const int degree = from.value<int>();
  const bool antialiased = from.truth(), two_sided = from.truth();
  const auto box = from.value<WideBox>();
  std::vector<std::pair<std::string, std::string>> metadata(from.count(2 * sizeof(std::uint64_t)));
  for (auto& [key, value] : metadata) {
    key = from.text();
    value = from.text();
  }
  if (box.empty()) return;  // the rank has no splats
  all.degree = degree;
  all.antialiased = antialiased;
  all.two_sided = two_sided;
  all.box.add(box);
  add_piece(all.metadata, metadata);
}

}  // namespace

std::optional<SplatSurvey> survey_splats(std::string_view path, std::span<const std::byte> bytes, std::size_t more_than,
                                         const PutAside& put_aside, qnv::Ranks& ranks) {
  const auto read = [&]() -> std::optional<SplatSurvey> {
    const auto file = runs_of(path, bytes, more_than, put_aside);
    return file ? own_survey(*file, qnv::share_of(ranks, file->runs())) : std::nullopt;
  };
  if (ranks.count() == 1) return read();
  // A rank that fails still calls the collective functions. Otherwise, the other ranks would wait for it.
  std::vector<std::byte> text;
  try {
    if (const auto own = read()) text = bytes_of(*own);
  } catch (...) {
    text.clear();  // for example, memory does not suffice
  }
  const std::uint64_t size = text.size();
  const auto sizes = qnv::gather_records<std::uint64_t>(ranks, std::span(&size, 1));
  const std::vector<std::byte> all = ranks.gather(text);
  if (std::ranges::find(sizes, std::uint64_t{0}) != sizes.end()) return std::nullopt;
  std::optional<SplatSurvey> survey(std::in_place);
  try {
    for (TransferReader from(all); !from.empty();) add_survey(*survey, from);
  } catch (...) {
    survey = std::nullopt;
  }
  const std::byte failed{survey ? std::uint8_t{0} : std::uint8_t{1}};
  if (std::ranges::count(ranks.gather(std::span(&failed, 1)), std::byte{1}) > 0) return std::nullopt;
  return survey;
}

std::optional<SplatFile> open_splat_file(std::string_view path, std::span<const std::byte> bytes, std::size_t more_than,
                                         const PutAside& put_aside, const SplatSurvey* known) {
  auto opened = runs_of(path, bytes, more_than, put_aside);
  if (!opened) return std::nullopt;
  const auto runs = std::make_shared<const FileRuns>(std::move(*opened));
  std::optional<SplatSurvey> read;
  if (!known) read = own_survey(*runs, {0, runs->runs()});
  const SplatSurvey* const survey = known ? known : read ? &*read : nullptr;
  if (!survey || survey->runs.size() != runs->runs()) return std::nullopt;
  SplatFile file;
  qnv::GaussianSource& source = file.source;
  qnv::Description& description = source.base.description;
  source.degree = survey->degree;
  source.antialiased = survey->antialiased;
  description.two_sided = survey->two_sided;
  description.metadata = survey->metadata;
  for (const SplatSurvey::Run& run : survey->runs) {
    source.count += run.splats;
    source.runs.push_back(run.splats);
    description.total += run.area;
  }
  const auto kept = [](const auto& pair) { return pair.first == kSplatsAsDiscs; };
  if (source.count == 0 || std::ranges::none_of(description.metadata, kept)) return std::nullopt;
  if (runs->rows.announced > runs->rows.count)
    description.metadata.emplace_back("splats missing", std::to_string(runs->rows.announced - runs->rows.count));
  const WideBox& box = survey->box;
  description.origin = qnv::local_origin(box);
  description.box.add(glm::vec3(box.lower - description.origin));
  description.box.add(glm::vec3(box.upper - description.origin));
  source.read_run = [runs, origin = description.origin](std::uint64_t run,
                                                        const std::function<bool(const qnv::Gaussians&)>& take) {
    return runs->read(run, [&](const qnv::Gaussians& splats) {
      if (splats.description.origin == origin) return take(splats);
      qnv::Gaussians moved = splats;
      const glm::dvec3 move = splats.description.origin - origin;
      for (glm::vec3& p : moved.positions) p = glm::vec3(glm::dvec3(p) + move);
      return take(moved);
    });
  };
  source.read = [read_run = source.read_run, count = runs->runs()](const auto& take) {
    for (std::uint64_t run = 0; run < count; ++run)
      if (!read_run(run, take)) return false;
    return true;
  };
  return file;
}

}  // namespace gs::app
