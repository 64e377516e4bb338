#pragma once

#include "app/commands/common/open_input.h"
#include "app/commands/common/option_groups.h"
#include "app/commands/common/progress_bar.h"
#include "base/json_value.h"
#include "qnv/codecs/shared/encode_options.h"

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Inputs of `encode`: the files, which are the steps of a time series if there are several, and their content.
struct EncodeInput {
  std::vector<std::string> steps;
  OpenedInput input;
};

/// Opens the inputs. First checks that the output may be written, because encoding may take long. Prints errors.
/// `known` is the survey of a file of splats, which is then not surveyed again; it may be null.
[[nodiscard]] std::optional<EncodeInput> open_encode_input(const ConversionOptions& options, ProgressBar& progress,
                                                           const SplatSurvey* known = nullptr);
/// Surveys the input if it is a large file of splats, which the ranks read together. Returns nullopt for other inputs.
/// Collective.
[[nodiscard]] std::optional<SplatSurvey> survey_encode_input(const ConversionOptions& options, qnv::Ranks& ranks);

/// Returns an error if a stream is too large for the options.
[[nodiscard]] std::optional<std::string> check_size(const ConversionOptions& options, const qnv::EncodedStream& stream);

/// Form of the report of a stream.
struct EncodeReport {
  bool json = false;
  std::chrono::steady_clock::time_point start;  // of the command
  const JsonValue* ranks = nullptr;             // statistics of several processes, or null
};
/// Reports a written stream, and the properties of the input that were lost.
void report_encoding(const ConversionOptions& options, const EncodeInput& opened, const qnv::EncodedStream& stream,
                     const EncodeReport& report);

}  // namespace gs::app
