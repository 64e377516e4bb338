#include "app/commands/encode.h"

#include "app/base/console.h"
#include "app/commands/common/encode_report.h"
#include "app/commands/common/shared.h"
#include "app/commands/common/vectors_of.h"
#include "app/encode/encode_team.h"
#include "app/encode/part_store.h"
#include "net/files/file.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>
#include <variant>

namespace gs::app {

namespace {

using qnv::EncodeError;

/// Message that marks an error as already printed, for agreed().
constexpr char kPrinted[] = "\x01";

// Returns a text that identifies the version, the task, and the states of its input files.
std::string key_of(const EncodeTeam& team, const EncodeInput& opened) {
  std::string key = "ghostspace " GHOSTSPACE_VERSION "\n" + team.task();
  for (const std::string& file : opened.steps) {
    std::error_code error;
    const auto size = std::filesystem::file_size(file, error);
    const auto time = std::filesystem::last_write_time(file, error).time_since_epoch().count();
    key += "\n" + std::to_string(size) + " " + std::to_string(time);
  }
  // An input file may refer to other files, such as the voxels of a header or the pieces of a grid.
  for (const auto& files : opened.input.others) key += "\n" + files->text();
  if (const auto* const grid = std::get_if<LargeGrid>(&opened.input.content)) key += "\n" + grid->source->state();
  return key;
}

/// One `encode` command of several processes.
class TogetherEncoding {
 public:
  TogetherEncoding(const EncodeCommand& options, EncodeTeam& team)
      : options_(options), team_(team), ranks_(team.ranks()), folder_(options.files.back() + ".parts") {}

  int run();

 private:
  [[nodiscard]] bool leads() const { return ranks_.rank() == 0; }
  /// Returns true if no process has an error. Otherwise rank 0 prints the error of the first one. Collective.
  bool agreed(const std::optional<std::string>& own);
  bool open();
  bool prepare();
  bool encode();
  [[nodiscard]] std::optional<std::string> exceeds_memory() const;
  /// Opens the input in this process. Returns an error.
  std::optional<std::string> open_here();

  const EncodeCommand& options_;
  EncodeTeam& team_;
  qnv::Ranks& ranks_;
  std::string folder_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  ProgressBar progress_{leads()};      // the hidden output of the others is for errors
  std::optional<SplatSurvey> survey_;  // set if the input is a large file of splats
  std::optional<EncodeInput> opened_;
  bool shared_ = false;  // each process encodes a part; otherwise rank 0 encodes alone
  std::unique_ptr<PartStore> store_;
  std::unique_ptr<TeamFile> file_;
  qnv::EncodedStream stream_;
  bool unwritten_ = false;  // a process could not write its bytes
};

bool TogetherEncoding::agreed(const std::optional<std::string>& own) {
  const auto failed = qnv::agree(ranks_, own ? std::optional(EncodeError{*own}) : std::nullopt);
  if (failed && leads() && failed->message != kPrinted) (void)fail(failed->message);
  return !failed;
}

std::optional<std::string> TogetherEncoding::open_here() {
  opened_ = open_encode_input(options_, progress_, survey_ ? &*survey_ : nullptr);
  if (opened_) return std::nullopt;
  if (leads()) return kPrinted;
  return "rank " + std::to_string(ranks_.rank()) + ": " + team_.hidden_errors();
}

// Opens the input on rank 0 first, and on the other ranks only if they encode parts of it.
bool TogetherEncoding::open() {
  survey_ = survey_encode_input(options_, ranks_);
  std::optional<std::string> problem;
  if (leads()) problem = open_here();
  if (!agreed(problem)) return false;
  const std::byte own{leads() && shares_work(options_, opened_->input)};
  const std::vector<std::byte> all = ranks_.gather(std::span(&own, 1));
  shared_ = all.front() != std::byte{0};
  problem = shared_ && !leads() ? open_here() : std::nullopt;
  if (shared_ && !problem) problem = exceeds_memory();
  return agreed(problem);
}

// Returns an error if the slices that a rank holds would exceed --memory.
std::optional<std::string> TogetherEncoding::exceeds_memory() const {
  const auto* const volume = std::get_if<qnv::VolumeSource>(&opened_->input.content);
  if (!volume) return std::nullopt;  // encoders of surfaces and splats respect the limit
  const auto& dimensions = volume->layout.dimensions;
  const std::uint64_t slices = std::min<std::uint64_t>(volume->layout.labels ? 4 : 64, dimensions[2]),
                      needed = slices * 4 * dimensions[0] * dimensions[1];
  if (needed <= options_.limits.memory) return std::nullopt;
  return options_.files.front() + ": slices of " + std::to_string(dimensions[0]) + " x " +
         std::to_string(dimensions[1]) + " voxels need " + std::to_string(needed >> 20) +
         " MiB in each process; raise --memory";
}

// Creates the files of all processes.
bool TogetherEncoding::prepare() {
  std::optional<std::string> problem;
  if (leads())
    if (auto failed = net::prepare_part_folder(folder_, key_of(team_, *opened_), options_.resume))
      problem = std::move(failed->message);
  if (!agreed(problem)) return false;
  const std::uint32_t free = leads() ? net::free_part_number(folder_) : 0;
  const std::uint32_t first = qnv::gather_records<std::uint32_t>(ranks_, std::span(&free, 1)).front();
  auto files = net::PartFiles::create(folder_, first + ranks_.rank());
  if (auto* failed = std::get_if<net::FileError>(&files))
    problem = "rank " + std::to_string(ranks_.rank()) + ": " + failed->message;
  else
    store_ = std::make_unique<PartStore>(std::move(std::get<net::PartFiles>(files)));
  if (!agreed(problem)) return false;
  file_ = team_.create(net::part_stream(folder_));
  if (!file_) problem = "cannot create " + net::part_stream(folder_);
  return agreed(problem);
}

bool TogetherEncoding::encode() {
  std::optional<std::string> problem;
  if (shared_ || leads()) {
    EncodeOutput output{store_.get(), file_.get(), nullptr, team_.threads()};
    if (shared_) output.ranks = &ranks_;
    auto encoded = encode_input(options_, opened_->input, progress_, output);
    if (auto* failed = std::get_if<EncodeError>(&encoded))
      problem = options_.files.front() + ": " + failed->message;
    else
      stream_ = std::move(std::get<qnv::EncodedStream>(encoded));
  }
  if (!problem && leads() && stream_.written == 0 && !file_->write(stream_.bytes)) problem = "cannot write the stream";
  if (!problem) problem = check_size(options_, stream_);
  // All ranks get the write error of one rank. It is the cause of that rank's encoder error, so it replaces that error.
  if (auto unwritten = file_->finish()) {
    problem = std::move(unwritten);
    unwritten_ = true;
  }
  file_.reset();
  return agreed(problem);
}

int TogetherEncoding::run() {
  const bool encoded = open() && prepare() && encode();
  std::optional<std::string> problem;
  if (encoded && leads())
    if (auto failed = net::publish_part_stream(folder_, options_.files.back())) problem = std::move(failed->message);
  const bool written = encoded && agreed(problem);
  const JsonValue statistics = team_.statistics();
  progress_.hide();
  if (written && leads()) report_encoding(options_, *opened_, stream_, {options_.json, start_, &statistics});
  team_.end_together();
  return written ? kDone : encoded || unwritten_ ? kNotWritten : kFailed;
}

}  // namespace

int encode_together(const EncodeCommand& options, EncodeTeam& team) { return TogetherEncoding(options, team).run(); }

}  // namespace gs::app
