#include "app/commands/common/encode_report.h"

#include "app/base/console.h"
#include "app/base/numbered_files.h"
#include "app/commands/common/conversion_report.h"
#include "app/commands/common/shared.h"
#include "app/formats/volume/coarser_volume.h"
#include "qnv/container/container.h"

#include <span>
#include <utility>

namespace gs::app {
namespace {

void print_facts(const ConversionOptions& options, const OpenedInput& input, const qnv::EncodedStream& stream,
                 const StreamContents& contents, const std::vector<std::string>& losses, const EncodeReport& report) {
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - report.start;
  const auto vectors = static_cast<double>(stream.header.vectors);
  JsonValue lost = JsonValue::list();
  for (const std::string& loss : losses) lost.add(loss);
  JsonValue facts =
      JsonValue::named({{"file", options.files.back()},
                        {"source", options.files[0]},
                        {"source_bytes", input.bytes},
                        {"contents", contents.text()},
                        {"texture", contents.texture},
                        {"mesh_at_end", contents.mesh_at_end},
                        {"losses", std::move(lost)},
                        {"vectors", stream.header.vectors},
                        {"bytes", stream.size()},
                        {"bits_per_vector", vectors > 0 ? static_cast<double>(stream.size()) * 8 / vectors : 0.0},
                        {"seconds", took.count()}});
  if (report.ranks) facts.put("ranks", *report.ranks);
  print_text(facts.json());
}

/// Returns the files of the steps of a time series, or a single file.
std::vector<std::string> steps_of(const ConversionOptions& options) {
  std::vector<std::string> steps(options.files.begin(), options.files.end() - 1);
  if (auto series = steps.size() == 1 ? file_series(steps.front()) : std::nullopt) steps = std::move(*series);
  return steps;
}

/// Reports whether splats may be read in pieces. Edits and other methods need all splats in memory.
bool in_pieces(const ConversionOptions& options, std::span<const std::string> steps) {
  return steps.size() == 1 && options.splats.empty() && options.fraction == 0 &&
         (options.method == EncodeMethod::automatic || options.method == EncodeMethod::gaussians);
}

}  // namespace

std::optional<SplatSurvey> survey_encode_input(const ConversionOptions& options, qnv::Ranks& ranks) {
  const std::vector<std::string> steps = steps_of(options);
  return survey_many_splats(in_pieces(options, steps) ? steps.front() : std::string(), ranks);
}

std::optional<EncodeInput> open_encode_input(const ConversionOptions& options, ProgressBar& progress,
                                             const SplatSurvey* known) {
  const std::string &in = options.files.front(), &out = options.files.back();
  std::vector<std::string> steps = steps_of(options);
  for (const std::string& step : steps)
    if (const auto refusal = refuse_to_replace(out, step, qnv::encode_header({}))) {
      (void)fail(*refusal);
      return std::nullopt;
    }
  progress.whole().stage = "reading";
  if (steps.empty()) {
    (void)fail(in + ": no file name matches this numbered pattern");
    return std::nullopt;
  }
  auto input = in_pieces(options, steps) ? open_many_splats(steps.front(), known) : std::nullopt;
  if (!input && steps.size() == 1 && !options.isovalue) input = open_grid_in_parts(options, steps.front());
  if (!input) input = steps.size() > 1 ? open_steps(options, steps) : open_input(options, steps.front());
  if (!input) return std::nullopt;
  if (const auto problem = edit_input(options.splats, *input)) {
    (void)fail(in + ": " + *problem);
    return std::nullopt;
  }
  if (auto* const volume = std::get_if<qnv::VolumeSource>(&input->content); volume && options.most_voxels > 0)
    if (const auto step = step_for_voxels(volume->layout, options.most_voxels); step > 1) {
      qnv::VolumeSource coarse = thinned(*volume, step);
      if (steps.size() > 1) {
        // The encoder rejects a step of another size.
        for (const qnv::VolumeSource& one : volume->steps)
          coarse.steps.push_back(one.layout.dimensions == volume->layout.dimensions ? thinned(one, step) : one);
        coarse.times = volume->times;
      } else if (volume->steps.size() > 1) {
        input->losses.push_back("--most-voxels keeps one of " + std::to_string(volume->steps.size()) + " steps");
      }
      input->content = std::move(coarse);
    }
  return EncodeInput{std::move(steps), std::move(*input)};
}

std::optional<std::string> check_size(const ConversionOptions& options, const qnv::EncodedStream& stream) {
  if (!options.max_bytes_given || stream.size() <= options.max_bytes) return std::nullopt;
  return "the smallest possible stream has " + std::to_string(stream.size()) + " bytes; expected at most " +
         std::to_string(options.max_bytes);
}

void report_encoding(const ConversionOptions& options, const EncodeInput& opened, const qnv::EncodedStream& stream,
                     const EncodeReport& report) {
  const std::string &in = options.files.front(), &out = options.files.back();
  const OpenedInput& input = opened.input;
  if (stream.thinned)
    complain("%s: warning: mesh exceeds --memory; simplified to %zu triangles (raise --memory to keep more)",
             in.c_str(), most_encoded_triangles(options.limits));
  const StreamContents contents = contents_of(stream, input);
  std::vector<std::string> losses = lost_properties(input);
  for (std::string& loss : lost_in_stream(input, contents)) losses.push_back(std::move(loss));
  print_losses(in, losses);
  if (report.json)
    print_facts(options, input, stream, contents, losses, report);
  else
    print_conversion({opened.steps.size() > 1 ? opened.steps.front() + " to " + opened.steps.back() : in, input.bytes,
                      out, stream.size(), contents.text()},
                     report.start);
}

}  // namespace gs::app
