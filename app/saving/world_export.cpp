#include "app/saving/world_export.h"

#include "app/saving/save_formats.h"
#include "app/serve/child_program.h"
#include "net/files/file.h"

#include <filesystem>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

constexpr ChildLimits kLimits{std::chrono::hours(12), std::uint64_t{64} << 30, std::uint64_t{1} << 40};

// Runs the export into a temporary file, then replaces the target. Returns the error, or nullopt.
std::optional<std::string> exported(const ExportSource& source, const std::string& target, const std::string& program,
                                    const std::stop_token& stop) {
  const TemporaryFile made(std::filesystem::path(target).filename().string(), {});
  if (!made.problem().empty()) return made.problem();
  std::vector<std::string> arguments{is_stream_path(target) ? "encode" : "export"};
  arguments.insert(arguments.end(), source.options.begin(), source.options.end());
  if (!source.folder.empty()) arguments.insert(arguments.end(), {"--allow", source.folder});
  arguments.insert(arguments.end(), {source.path, made.path()});
  if (const auto failure = run_child(program, arguments, kLimits, stop)) return failure->message;
  const auto opened = net::map_file(made.path());
  if (const auto* problem = std::get_if<net::FileError>(&opened)) return problem->message;
  remove_unfinished_beside(target);
  const auto problem = net::write_file_atomically(target, std::get<net::MappedFile>(opened).bytes());
  return problem ? std::optional(problem->message) : std::nullopt;
}

}  // namespace

WorldExport::WorldExport(ExportSource source, std::string target, std::function<void()> wake, std::string program)
    : source_(std::move(source)),
      target_(std::move(target)),
      wake_(std::move(wake)),
      program_(std::move(program)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void WorldExport::run(const std::stop_token& stop) {
  Result result{target_, exported(source_, target_, program_, stop)};
  {
    const std::lock_guard lock(mutex_);
    result_ = std::move(result);
  }
  if (wake_) wake_();
}

std::optional<WorldExport::Result> WorldExport::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

}  // namespace gs::app
