#include "app/cluster/mpi_team.h"

#include "app/base/exit_status.h"
#include "net/base/descriptor.h"
#include "net/files/part_files.h"

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <numeric>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace gs::app {
namespace {

/// Output through MPI-IO. Each rank collects its bytes, and all of them write one piece at a time together. Only
/// finish() closes the file: closing waits for all ranks, but a rank that fails alone must end without them.
class MpiFile final : public TeamFile {
 public:
  /// `space` is a descriptor of the file.
  MpiFile(MPI_File file, net::Descriptor space, bool has_front, std::uint64_t& written)
      : file_(file), space_(std::move(space)), has_front_(has_front), written_(written) {
    piece_.reserve(kPieceBytes);
  }
  MpiFile(const MpiFile&) = delete;
  MpiFile& operator=(const MpiFile&) = delete;
  ~MpiFile() override = default;

  bool write(std::span<const std::byte> bytes) override {
    while (!bytes.empty() && !failed_) {
      const auto part = bytes.first(std::min(bytes.size(), kPieceBytes - piece_.size()));
      if (piece_.empty()) piece_at_ = at_;
      piece_.insert(piece_.end(), part.begin(), part.end());
      at_ += part.size();
      bytes = bytes.subspan(part.size());
      if (piece_.size() == kPieceBytes) (void)write_piece();
    }
    return !failed_;
  }
  bool skip(std::uint64_t bytes) override {
    at_ += bytes;
    return true;
  }
  bool rewrite_front(std::span<const std::byte> bytes) override {
    front_.assign(bytes.begin(), bytes.end());
    return has_front_;
  }
  std::optional<std::string> finish() override {
    while (write_piece()) {
    }
    // Overwrites the front after the first piece, which contains its preliminary bytes.
    if (!front_.empty() && !failed_) put(0, front_);
    // All ranks close the file, because closing waits for all.
    if (MPI_File_sync(file_) != MPI_SUCCESS) fail("the file system did not store all bytes");
    if (MPI_File_close(&file_) != MPI_SUCCESS) fail("the file system did not store all bytes");
    return first_failure();
  }

 private:
  static constexpr std::size_t kPieceBytes = std::size_t{8} << 20;

  // Writes the collected bytes. Collective; a rank may have no bytes. Returns false if no rank has bytes.
  bool write_piece() {
    int own = piece_.empty() ? 0 : 1, any = 0;
    MPI_Allreduce(&own, &any, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    if (any == 0) return false;
    reserve_space();
    MPI_Status status;
    check(MPI_File_write_at_all(file_, static_cast<MPI_Offset>(piece_at_), piece_.data(),
                                static_cast<int>(piece_.size()), MPI_BYTE, &status),
          status, piece_.size());
    piece_.clear();
    return true;
  }
  // Reserves the space of the collected bytes, and drops them if the disk is full. Open MPI 4.1 reports success when it
  // writes to a full disk.
  void reserve_space() {
    if (piece_.empty() ||
        ::fallocate(space_.get(), 0, static_cast<off_t>(piece_at_), static_cast<off_t>(piece_.size())) == 0)
      return;
    const int error = errno;
    if (error != ENOSPC && error != EDQUOT && error != EFBIG) return;  // the file system cannot reserve space
    fail(std::strerror(error));
    piece_.clear();
  }
  void put(std::uint64_t at, std::span<const std::byte> bytes) {
    MPI_Status status;
    check(MPI_File_write_at(file_, static_cast<MPI_Offset>(at), bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE,
                            &status),
          status, bytes.size());
  }
  void check(int result, const MPI_Status& status, std::size_t bytes) {
    int got = 0;
    if (result == MPI_SUCCESS) MPI_Get_count(&status, MPI_BYTE, &got);
    written_ += static_cast<std::uint64_t>(got);
    if (result == MPI_SUCCESS && static_cast<std::size_t>(got) == bytes) return;
    std::array<char, MPI_MAX_ERROR_STRING> text{};
    int length = 0;
    if (result != MPI_SUCCESS) MPI_Error_string(result, text.data(), &length);
    fail(length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : "the disk is full");
  }
  void fail(const std::string& reason) {
    if (!failed_) reason_ = reason;
    failed_ = true;
  }
  // Returns the failure of the lowest failed rank; all ranks get this failure. Collective.
  [[nodiscard]] std::optional<std::string> first_failure() const {
    int rank = 0, first = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    const int own = failed_ ? rank : INT_MAX;
    MPI_Allreduce(&own, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (first == INT_MAX) return std::nullopt;
    std::array<char, MPI_MAX_ERROR_STRING + 1> text{};
    if (rank == first) (void)reason_.copy(text.data(), text.size() - 1);
    MPI_Bcast(text.data(), static_cast<int>(text.size()), MPI_CHAR, first, MPI_COMM_WORLD);
    return "cannot write the stream: " + std::string(text.data());
  }

  MPI_File file_;
  net::Descriptor space_;
  bool has_front_;
  std::uint64_t& written_;
  std::uint64_t at_ = 0, piece_at_ = 0;
  std::vector<std::byte> piece_, front_;
  bool failed_ = false;
  std::string reason_;
};

// Data of the signal handler: path of a file that the first ending process creates, and the output descriptor.
std::array<char, 4096> end_mark{};
int end_output = -1;
bool end_leads = false;
volatile std::sig_atomic_t end_agreed = 0;  // 1 if all processes end together; rank 0 has printed the reason

// Returns true in only one process, which then prints the reason why the run ends.
bool claims_end() {
  return end_mark[0] == '\0' ? end_leads : ::open(end_mark.data(), O_CREAT | O_EXCL | O_CLOEXEC, 0666) >= 0;
}

// Handles SIGTERM, which MPI sends after a process died, and batch systems send to end a run. One process prints.
extern "C" void end_process(int) {
  constexpr char kLine[] =
      "ghostspace-mpi: error: a process died, or the system ended the run; the output was not written, --resume "
      "continues\n";
  if (end_agreed != 0) ::_exit(kFailed);
  if (claims_end()) (void)!::write(end_output, kLine, sizeof kLine - 1);
  ::_exit(kFailed);
}

// Reports whether a condition holds on all ranks. Collective.
bool on_all_ranks(bool own) {
  int good = own ? 1 : 0, all = 0;
  MPI_Allreduce(&good, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  return all != 0;
}

net::Descriptor opened_file(const std::string& path, int flags) {
  return net::Descriptor(::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW, 0666));
}

}  // namespace

MpiRanks::MpiRanks() {
  int rank = 0, count = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &count);
  rank_ = static_cast<std::uint32_t>(rank);
  count_ = static_cast<std::uint32_t>(count);
}

std::vector<std::byte> MpiRanks::gather(std::span<const std::byte> own) {
  std::uint64_t size = own.size();
  std::vector<std::uint64_t> sizes(count_);
  MPI_Allgather(&size, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
  const std::uint64_t all = std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0});
  std::vector<std::byte> bytes(static_cast<std::size_t>(all));
  ++messages_;
  sent_ += sizeof size + size;
  largest_ = std::max(largest_, size);
  if (all == 0) return bytes;
  if (all <= INT_MAX) {
    std::vector<int> counts(count_), places(count_);
    for (std::uint32_t i = 0, at = 0; i < count_; at += static_cast<std::uint32_t>(sizes[i++])) {
      counts[i] = static_cast<int>(sizes[i]);
      places[i] = static_cast<int>(at);
    }
    MPI_Allgatherv(own.data(), static_cast<int>(size), MPI_BYTE, bytes.data(), counts.data(), places.data(), MPI_BYTE,
                   MPI_COMM_WORLD);
    return bytes;
  }
  // MPI counts are int. For more bytes, each rank in turn broadcasts its bytes in pieces.
  std::uint64_t at = 0;
  for (std::uint32_t from = 0; from < count_; ++from)
    for (std::uint64_t done = 0; done < sizes[from];) {
      const int part = static_cast<int>(std::min<std::uint64_t>(sizes[from] - done, INT_MAX));
      std::byte* const to = bytes.data() + at + done;
      if (from == rank_) std::memcpy(to, own.data() + done, static_cast<std::size_t>(part));
      MPI_Bcast(to, part, MPI_BYTE, static_cast<int>(from), MPI_COMM_WORLD);
      done += static_cast<std::uint64_t>(part);
      if (done == sizes[from]) at += done;
    }
  return bytes;
}

MpiTeam::Start::Start(int* count, char*** arguments) {
  int provided = 0;
  // Only the main thread calls MPI.
  MPI_Init_thread(count, arguments, MPI_THREAD_FUNNELED, &provided);
}

MpiTeam::MpiTeam(int* count, char*** arguments) : start_(count, arguments) {
  for (int i = 1; i < *count; ++i)
    if (std::strcmp((*arguments)[i], "--resume") != 0) task_ += std::string(i > 1 ? "\n" : "") + (*arguments)[i];
  MPI_Comm machine = MPI_COMM_NULL;
  int here = 1;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &here);
  MPI_Comm_free(&machine);
  threads_ = std::max(1u, std::thread::hardware_concurrency() / static_cast<unsigned>(here));
  if (ranks_.rank() != 0) hide_output();
  end_leads = ranks_.rank() == 0;
  end_output = shown_ >= 0 ? shown_ : STDERR_FILENO;
  struct sigaction action {};
  action.sa_handler = end_process;
  ::sigaction(SIGTERM, &action, nullptr);
}

// Redirects the output of this rank, because errors of all ranks would appear several times or mixed.
void MpiTeam::hide_output() {
  shown_ = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  errors_ = ::memfd_create("errors", MFD_CLOEXEC);
  const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nothing >= 0) (void)::dup2(nothing, STDOUT_FILENO);
  if (errors_ >= 0) (void)::dup2(errors_, STDERR_FILENO);
  if (nothing >= 0) (void)::close(nothing);
}

void MpiTeam::end_together() {
  together_ = true;
  end_agreed = 1;
}

std::string MpiTeam::hidden_errors() const {
  if (errors_ < 0) return {};
  std::string text(1000, '\0');
  const off_t end = ::lseek(errors_, 0, SEEK_END), most = static_cast<off_t>(text.size());
  const ssize_t got = ::pread(errors_, text.data(), text.size(), std::max<off_t>(0, end - most));
  text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t line = text.rfind('\n');
  if (line != std::string::npos) text.erase(0, line + 1);
  constexpr std::string_view kProgram = "ghostspace: error: ";
  return text.starts_with(kProgram) ? text.substr(kProgram.size()) : text;
}

std::unique_ptr<TeamFile> MpiTeam::create(const std::string& path) {
  const std::string mark = net::part_end_mark(path);
  if (ranks_.rank() == 0) ::unlink(mark.c_str());
  // MPI may wait forever if only one rank cannot open the file. So each rank opens it here first.
  if (!on_all_ranks(ranks_.rank() != 0 || opened_file(path, O_WRONLY | O_CREAT | O_TRUNC))) return nullptr;
  net::Descriptor space = opened_file(path, O_WRONLY);
  if (!on_all_ranks(static_cast<bool>(space))) return nullptr;
  MPI_File file = MPI_FILE_NULL;
  const bool opened = MPI_File_open(MPI_COMM_WORLD, path.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file) == MPI_SUCCESS;
  if (!on_all_ranks(opened)) return nullptr;
  if (mark.size() < end_mark.size()) std::ranges::copy(mark, end_mark.begin());
  return std::make_unique<MpiFile>(file, std::move(space), ranks_.rank() == 0, written_);
}

JsonValue MpiTeam::statistics() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto milliseconds = [](const timeval& time) {
    return static_cast<std::uint64_t>(time.tv_sec) * 1000 + static_cast<std::uint64_t>(time.tv_usec) / 1000;
  };
  const std::array<std::uint64_t, 6> own{ranks_.messages(),
                                         ranks_.sent_bytes(),
                                         ranks_.largest_message(),
                                         written_,
                                         static_cast<std::uint64_t>(usage.ru_maxrss) * 1024,
                                         milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime)};
  const auto all = qnv::gather_records<std::uint64_t>(ranks_, own);
  JsonValue list = JsonValue::list();
  for (std::size_t i = 0; i + own.size() <= all.size(); i += own.size())
    list.add(JsonValue::named({{"messages", all[i]},
                               {"sent_bytes", all[i + 1]},
                               {"largest_message", all[i + 2]},
                               {"written_bytes", all[i + 3]},
                               {"peak_memory", all[i + 4]},
                               {"cpu_seconds", static_cast<double>(all[i + 5]) / 1000}}));
  return list;
}

MpiTeam::~MpiTeam() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (finalized != 0) return;
  if (!together_ && ranks_.count() > 1) {
    // Only this process failed, perhaps while others wait for it. Rank 0 has already printed its own errors.
    const bool first = claims_end();
    if ((first || end_mark[0] == '\0') && ranks_.rank() != 0 && shown_ >= 0) {
      const std::string line =
          "ghostspace-mpi: error: rank " + std::to_string(ranks_.rank()) + ": " + hidden_errors() + "\n";
      (void)!::write(shown_, line.data(), line.size());
    }
    MPI_Abort(MPI_COMM_WORLD, kFailed);
  }
  MPI_Finalize();
}

}  // namespace gs::app
