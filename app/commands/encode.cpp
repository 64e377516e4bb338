#include "app/commands/encode.h"

#include "app/commands/common/encode_report.h"
#include "app/commands/common/progress_bar.h"
#include "app/commands/common/shared.h"
#include "app/commands/common/vectors_of.h"
#include "app/encode/encode_spill.h"
#include "app/encode/encode_team.h"
#include "app/encode/file_sink.h"
#include "net/files/atomic_file.h"

#include <chrono>
#include <span>
#include <utility>

namespace gs::app {

namespace {

// Share of the memory limit that encoded clusters may take before they go to a temporary file: 32 MB by default. While
// they grow and move, they take three times as much.
constexpr std::size_t kSpillShare = 64;

}  // namespace

std::optional<std::string> check_encode(const EncodeCommand& options) {
  const EncodeMethod method = options.method;
  const bool outlines = method == EncodeMethod::outlines;
  if ((options.vectors > 0) + (options.fraction > 0) + options.max_bytes_given > 1)
    return "--vectors, --fraction and --max-bytes exclude each other; expected one of them";
  if (options.resume && !encode_team()) return "--resume continues a run of ghostspace-mpi; leave it out";
  if (encode_team() && outlines) return "--method outlines has no parts that processes share; use ghostspace encode";
  if (options.methods_differ) return "the methods exclude each other; expected one --method";
  if (options.exact_bits > 0 && method != EncodeMethod::automatic && method != EncodeMethod::displaced)
    return "--keep-mesh needs --method auto or displaced; other methods have no mesh";
  if (options.exact_bits > 0 && (options.vectors > 0 || options.fraction > 0 || options.max_bytes_given))
    return "--keep-mesh excludes --vectors, --fraction and --max-bytes, because the size of the mesh is fixed";
  const qnv::ValueTolerance& tolerance = options.value_tolerance;
  if (tolerance.lossless && tolerance.error) return "--lossless and --error exclude each other; expected one of them";
  if ((tolerance.lossless || tolerance.error) &&
      ((method != EncodeMethod::automatic && method != EncodeMethod::values && method != EncodeMethod::gaussians) ||
       options.vectors > 0 || options.fraction > 0 || options.isovalue))
    return "--error and --lossless apply to values only, --error also to Gaussians; leave out --vectors, --fraction "
           "and --isovalue, and use --method values or gaussians";
  if ((tolerance.lossless || tolerance.error) && options.max_bytes_given)
    return "--max-bytes excludes --error and --lossless, because either decides where the stream ends";
  if (method == EncodeMethod::values && (options.vectors > 0 || options.fraction > 0))
    return "--method values excludes --vectors and --fraction, which select gradients";
  if (options.parity.value_or(0) > 0 && method != EncodeMethod::automatic && method != EncodeMethod::displaced &&
      method != EncodeMethod::values && method != EncodeMethod::gaussians)
    return "--parity protects displaced meshes, volumes and Gaussians only; expected --method auto, displaced, values "
           "or gaussians";
  if (options.files.size() > 2 && (method != EncodeMethod::automatic && method != EncodeMethod::values))
    return "several inputs are the steps of a time series; expected volumes and --method auto or values";
  for (const std::string& file : std::span(options.files).first(options.files.size() - 1))
    if (options.files.size() > 2 && file.ends_with(".qnv"))
      return "several inputs are the steps of a time series; expected volumes, not '" + file + "'";
  if (options.files.size() > 2 && (options.vectors > 0 || options.fraction > 0 || options.isovalue))
    return "several inputs are the steps of a time series; --vectors, --fraction and --isovalue exclude them";
  if (outlines) {
    if (options.vectors > 0 || options.fraction > 0) return "--method outlines excludes --vectors and --fraction";
    const std::string& out = options.files.back();
    if (!out.ends_with(".wrl") && !out.ends_with(".wrz") && !out.ends_with(".qnv"))
      return "expected OUT.wrl, OUT.wrz or OUT.qnv as the second file, not '" + out + "'";
    return options.max_bytes_given && !out.ends_with(".qnv")
               ? std::optional<std::string>("--max-bytes applies to streams only; expected OUT.qnv")
               : std::nullopt;
  }
  if (!options.files.back().ends_with(".qnv"))
    return "expected OUT.qnv as the last file, not '" + options.files.back() + "'";
  return std::nullopt;
}

int run_encode(const EncodeCommand& options) {
  if (EncodeTeam* const team = encode_team()) return encode_together(options, *team);
  if (options.method == EncodeMethod::outlines) return encode_outlines(options);
  const std::string &in = options.files.front(), &out = options.files.back();
  const auto start = std::chrono::steady_clock::now();
  ProgressBar progress;
  const auto opened = open_encode_input(options, progress);
  if (!opened) return kFailed;
  const OpenedInput& input = opened->input;
  auto begun = net::AtomicFile::begin(out);
  if (const auto* problem = std::get_if<net::FileError>(&begun)) return fail_to_write(problem->message);
  auto& file = std::get<net::AtomicFile>(begun);
  EncodeSpill spill(options.limits.memory / kSpillShare, file.folder());
  FileSink sink(file);
  auto encoded = encode_input(options, input, progress, {&spill, &sink});
  if (progress.cancelled()) return fail("cancelled; " + out + " was not written");
  if (file.problem()) return fail_to_write(file.problem()->message);
  if (const auto* problem = std::get_if<qnv::EncodeError>(&encoded)) return fail(in + ": " + problem->message);
  const auto& stream = std::get<qnv::EncodedStream>(encoded);
  if (const auto problem = check_size(options, stream)) return fail(in + ": " + *problem);
  if (stream.written == 0) file.write(stream.bytes);
  if (const auto problem = file.commit()) return fail_to_write(problem->message);
  progress.hide();
  report_encoding(options, *opened, stream, {options.json, start});
  return kDone;
}

}  // namespace gs::app
