#include <algorithm>
#include <array>
#include <cerrno>
#include <map>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "net/base/url.h"
#include "net/load/transport.h"

namespace gs::net {
namespace {

/// Returns the version of a file. Writing changes at least one of these numbers, unless the writer resets them.
std::string version_of(const struct stat& status) {
  return '"' + std::to_string(status.st_ino) + '-' + std::to_string(status.st_size) + '-' +
         std::to_string(status.st_mtim.tv_sec) + '.' + std::to_string(status.st_mtim.tv_nsec) + '"';
}

std::string what_is(const struct stat& status) {
  if (S_ISDIR(status.st_mode)) return "it is a folder; expected a file";
  if (S_ISFIFO(status.st_mode)) return "it is a pipe; expected a regular file";
  if (S_ISSOCK(status.st_mode)) return "it is a socket; expected a regular file";
  return "it is a device; expected a regular file";
}

TransferEnd failure(LoadErrorKind kind, std::string message) { return {LoadError{kind, std::move(message)}, false}; }

/// Reads one block of each transfer per step, so that a large file does not delay a small one.
class FileTransport final : public Transport {
 public:
  FileTransport() = default;
  ~FileTransport() override {
    for (auto& [id, transfer] : transfers_) close(transfer);
  }

  void start(TransferId id, const TransferRequest& request, TimePoint) override { transfers_[id].request = request; }
  void cancel(TransferId id) override {
    if (const auto found = transfers_.find(id); found != transfers_.end()) found->second.over = true;
  }
  void pause(TransferId id, bool paused) override {
    if (const auto found = transfers_.find(id); found != transfers_.end()) found->second.paused = paused;
  }
  void step(TransferSink& sink, TimePoint) override {
    for (auto& [id, transfer] : transfers_) {
      if (transfer.over || transfer.paused) continue;
      const auto end = transfer.file < 0 ? begin(id, transfer, sink) : advance(id, transfer, sink);
      if (!end || transfer.over) continue;
      transfer.over = true;
      sink.on_end(id, *end);
    }
    for (auto& [id, transfer] : transfers_)
      if (transfer.over) close(transfer);
    std::erase_if(transfers_, [](const auto& entry) { return entry.second.over; });
  }
  [[nodiscard]] std::optional<TimePoint> deadline(TimePoint now) const override {
    for (const auto& [id, transfer] : transfers_)
      if (transfer.over || !transfer.paused) return now;
    return std::nullopt;
  }

 private:
  struct Transfer {
    TransferRequest request;
    int file = -1;
    struct stat status {};
    std::uint64_t next = 0, end = 0;
    bool paused = false, over = false;
  };

  static void close(Transfer& transfer) {
    if (transfer.file >= 0) ::close(transfer.file);
    transfer.file = -1;
  }

  static std::optional<TransferEnd> open(Transfer& transfer) {
    const Url url = parse_url(transfer.request.url);
    if (!url.authority.empty() && url.authority != "localhost")
      return failure(LoadErrorKind::bad_request,
                     "files on the host " + url.authority.substr(0, 64) + " cannot be reached; expected file:///path");
    const std::string path = path_of_url(url);
    if (path.empty()) return failure(LoadErrorKind::bad_request, "it has no file name; expected file:///path");
    // Do not wait for the other end of a pipe, and do not take over a terminal.
    transfer.file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    const int code = errno;
    if (transfer.file < 0) {
      if (::stat(path.c_str(), &transfer.status) == 0 && !S_ISREG(transfer.status.st_mode))
        return failure(LoadErrorKind::unreadable, what_is(transfer.status));
      return failure(code == ENOENT || code == ENOTDIR ? LoadErrorKind::not_found : LoadErrorKind::unreadable,
                     std::generic_category().message(code));
    }
    if (::fstat(transfer.file, &transfer.status) != 0)
      return failure(LoadErrorKind::unreadable, std::generic_category().message(errno));
    if (!S_ISREG(transfer.status.st_mode)) return failure(LoadErrorKind::unreadable, what_is(transfer.status));
    return std::nullopt;
  }

  static std::optional<TransferEnd> begin(TransferId id, Transfer& transfer, TransferSink& sink) {
    if (auto error = open(transfer)) return error;
    const auto size = static_cast<std::uint64_t>(transfer.status.st_size);
    ResponseHead head;
    head.accepts_ranges = true;
    head.validator.etag = version_of(transfer.status);
    transfer.end = size;
    const auto& range = transfer.request.range;
    const bool unchanged = transfer.request.if_range.empty() || transfer.request.if_range == head.validator.etag;
    if (range && unchanged && (range->begin > 0 || range->end < size)) {
      if (range->begin >= size)
        return failure(LoadErrorKind::bad_request,
                       "byte " + std::to_string(range->begin) + " was requested; it has " + std::to_string(size));
      head.status = 206;
      transfer.next = range->begin;
      transfer.end = std::min(range->end, size);
      head.content_range = ContentRange{transfer.next, transfer.end, size};
    }
    head.content_length = transfer.end - transfer.next;
    transfer.over = sink.on_head(id, head) != HeadVerdict::take;
    if (transfer.over || transfer.next < transfer.end) return std::nullopt;
    return TransferEnd{};
  }

  std::optional<TransferEnd> advance(TransferId id, Transfer& transfer, TransferSink& sink) {
    const std::size_t wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(block_.size(), transfer.end - transfer.next));
    const ssize_t got = ::pread(transfer.file, block_.data(), wanted, static_cast<off_t>(transfer.next));
    if (got < 0 && errno == EINTR) return std::nullopt;
    if (got < 0) return failure(LoadErrorKind::unreadable, std::generic_category().message(errno));
    // Checked after reading, so that bytes of a newer version are not accepted.
    struct stat status {};
    if (::fstat(transfer.file, &status) != 0 || version_of(status) != version_of(transfer.status) || got == 0)
      return TransferEnd{LoadError{LoadErrorKind::changed, "the file changed while it was read"}, true};
    transfer.next += static_cast<std::uint64_t>(got);
    const DataVerdict verdict = sink.on_data(id, std::span(block_).first(static_cast<std::size_t>(got)));
    transfer.over = verdict == DataVerdict::stop;
    transfer.paused |= verdict == DataVerdict::pause;
    if (transfer.over || transfer.next < transfer.end) return std::nullopt;
    return TransferEnd{};
  }

  std::map<TransferId, Transfer> transfers_;
  std::array<std::byte, std::size_t{128} << 10> block_{};
};

}  // namespace

std::unique_ptr<Transport> make_file_transport() { return std::make_unique<FileTransport>(); }

}  // namespace gs::net
