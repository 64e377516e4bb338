// Measures the time to the first picture, to a usable one and to the end, on links of given rate, delay and loss, for
// one model in many formats, over HTTP and as cells.
//
//   transfer --model FILE [...]   (transfer_options.cpp has them all)
//
// Each link is two network namespaces with a thread that carries their packets (link_emulator.h). The server is
// `ghostspace serve`, the client net::Loader or net::CellClientDriver, with the kernel's TCP. Pictures are drawn after
// the transfers, from the data received at each time. Prints Markdown. Needs root or `unshare -r`, and for Draco's row
// draco_encoder and draco_decoder in the PATH.
#include "bench/transfer/jobs.h"
#include "bench/transfer/model.h"
#include "bench/transfer/options.h"
#include "bench/transfer/run.h"
#include "bench/transfer/tables.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include <unistd.h>

namespace {

using namespace gs::bench;

int measure(TransferOptions options, const std::string& scratch) {
  Studio studio;
  if (!studio.good()) {
    std::fprintf(stderr, "transfer: no way to draw here\n");
    return 1;
  }
  options.model.folder = scratch;
  auto made = Model::make(options.model, studio);
  if (const auto* problem = std::get_if<std::string>(&made)) {
    std::fprintf(stderr, "transfer: %s\n", problem->c_str());
    return 1;
  }
  Model& model = *std::get<std::unique_ptr<Model>>(made);
  ServerSpec server{options.program, model.folder(), scratch + "/cache", {}};
  if (!options.congestion.empty()) server.arguments = {"--congestion", options.congestion};
  print_settings(options, model);
  const auto thresholds = print_sizes(options, model);
  bool good = true;
  if (options.matrix) good = print_matrix(options, model, server, thresholds) && good;
  if (options.loss) good = print_loss(options, model, server) && good;
  if (!options.archive.empty()) good = print_archive(options, studio, server) && good;
  return good ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  const auto read = transfer_options(count, arguments);
  if (const auto* problem = std::get_if<std::string>(&read)) {
    std::fprintf(stderr, "transfer: %s\n%s", problem->c_str(), transfer_usage());
    return 2;
  }
  const auto& options = std::get<TransferOptions>(read);
  // Checks that links are possible before minutes of work.
  auto link = EmulatedLink::create({}, options.tcp);
  if (const auto* problem = std::get_if<std::string>(&link)) {
    std::fprintf(stderr, "transfer: %s\n", problem->c_str());
    return 1;
  }
  std::get<std::unique_ptr<EmulatedLink>>(link).reset();
  std::string scratch = (std::filesystem::temp_directory_path() / "transfer_XXXXXX").string();
  if (!::mkdtemp(scratch.data())) {
    std::fprintf(stderr, "transfer: no folder for what is made\n");
    return 1;
  }
  const int result = measure(options, scratch);
  std::error_code error;
  std::filesystem::remove_all(scratch, error);
  return result;
}
