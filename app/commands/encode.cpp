#include "app/commands/encode.h"

#include "app/base/console.h"
#include "app/commands/common/progress_bar.h"
#include "app/commands/common/shared.h"
#include "app/commands/common/vectors_of.h"
#include "base/json_value.h"
#include "net/files/file.h"
#include "qnv/container/container.h"

#include <chrono>

namespace gs::app {

std::optional<std::string> check_encode(const EncodeCommand& options) {
  if ((options.vectors > 0) + (options.fraction > 0) + options.max_bytes_given > 1)
    return "--vectors, --fraction and --max-bytes exclude each other; expected one of them";
  if (options.packed + options.records + options.displaced > 1)
    return "--displaced, --packed and --records exclude each other; expected one of them";
  if (options.exact_bits > 0 && (options.packed || options.records || options.outlines))
    return "--exact excludes --packed, --records and --outlines";
  if (options.exact_bits > 0 && (options.vectors > 0 || options.fraction > 0 || options.max_bytes_given))
    return "--exact excludes --vectors, --fraction and --max-bytes, because the size of the exact mesh is fixed";
  if (options.outlines) {
    if (options.packed || options.records || options.displaced || options.vectors > 0 || options.fraction > 0)
      return "--outlines excludes --displaced, --packed, --records, --vectors and --fraction";
    const std::string& out = options.files.back();
    if (!out.ends_with(".wrl") && !out.ends_with(".wrz") && !out.ends_with(".qnv"))
      return "expected OUT.wrl, OUT.wrz or OUT.qnv as the second file, not '" + out + "'";
    return options.max_bytes_given && !out.ends_with(".qnv")
               ? std::optional<std::string>("--max-bytes applies to streams only; expected OUT.qnv")
               : std::nullopt;
  }
  if (!options.files.back().ends_with(".qnv"))
    return "expected OUT.qnv as the second file, not '" + options.files.back() + "'";
  return std::nullopt;
}

int run_encode(const EncodeCommand& options) {
  if (options.outlines) return encode_outlines(options);
  const std::string &in = options.files[0], &out = options.files[1];
  const auto start = std::chrono::steady_clock::now();
  // The work may be long. Check before it whether the output may be written.
  if (const auto refusal = refuse_to_replace(out, in, qnv::encode_header({}))) return fail(*refusal);
  const auto input = open_input(options, in);
  if (!input) return kFailed;
  ProgressBar progress;
  auto encoded = encode_input(options, *input, progress);
  if (progress.cancelled()) return fail("cancelled; " + out + " was not written");
  if (const auto* problem = std::get_if<qnv::EncodeError>(&encoded)) return fail(in + ": " + problem->message);
  const auto& stream = std::get<qnv::EncodedStream>(encoded);
  if (options.max_bytes_given && stream.bytes.size() > options.max_bytes)
    return fail(in + ": the smallest possible stream has " + std::to_string(stream.bytes.size()) +
                " bytes; expected at most " + std::to_string(options.max_bytes));
  if (const auto problem = net::write_file_atomically(out, stream.bytes)) return fail_to_write(problem->message);
  if (stream.thinned)
    complain("%s: warning: mesh exceeds --memory; simplified to %zu triangles (raise --memory to keep more)",
             in.c_str(), most_encoded_triangles(options.limits));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto vectors = static_cast<double>(stream.header.vectors);
  const double bits = vectors > 0 ? static_cast<double>(stream.bytes.size()) * 8 / vectors : 0;
  if (options.json) {
    const JsonValue facts = JsonValue::named({{"file", out},
                                              {"vectors", stream.header.vectors},
                                              {"bytes", stream.bytes.size()},
                                              {"bits_per_vector", bits},
                                              {"seconds", seconds}});
    print_text(facts.json());
  } else {
    print_line("%s: %llu vectors, %zu bytes, %.2f bits/vector, %.2f s", out.c_str(),
               static_cast<unsigned long long>(stream.header.vectors), stream.bytes.size(), bits, seconds);
  }
  return kDone;
}

}  // namespace gs::app
