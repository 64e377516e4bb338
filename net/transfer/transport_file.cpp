#include "net/base/descriptor.h"
#include "net/base/url.h"
#include "net/transfer/local_transport.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gs::net {
namespace {

/// Returns a text that identifies the version of a file. Writing the file changes it, unless the writer resets all
/// times.
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

struct FileTransfer : LocalTransfer {
  Descriptor file;
  struct stat status {};
};

/// Transport of files. Reads one block of each transfer per step, so that a large file does not delay a small file.
class FileTransport final : public LocalTransport<FileTransfer> {
  static std::optional<TransferEnd> open(FileTransfer& transfer) {
    const Url url = parse_url(transfer.request.url);
    if (!url.authority.empty() && url.authority != "localhost")
      return failure(LoadErrorKind::bad_request,
                     "files on the host " + url.authority.substr(0, 64) + " cannot be reached; expected file:///path");
    const std::string path = path_of_url(url);
    if (path.empty()) return failure(LoadErrorKind::bad_request, "it has no file name; expected file:///path");
    // O_NONBLOCK: do not wait for the other end of a pipe. O_NOCTTY: do not make a terminal the controlling terminal.
    transfer.file = Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    const int code = errno;
    if (!transfer.file) {
      if (::stat(path.c_str(), &transfer.status) == 0 && !S_ISREG(transfer.status.st_mode))
        return failure(LoadErrorKind::unreadable, what_is(transfer.status));
      return failure(code == ENOENT || code == ENOTDIR ? LoadErrorKind::not_found : LoadErrorKind::unreadable,
                     std::generic_category().message(code));
    }
    if (::fstat(transfer.file.get(), &transfer.status) != 0)
      return failure(LoadErrorKind::unreadable, std::generic_category().message(errno));
    if (!S_ISREG(transfer.status.st_mode)) return failure(LoadErrorKind::unreadable, what_is(transfer.status));
    return std::nullopt;
  }

  std::optional<TransferEnd> advance(TransferId id, FileTransfer& transfer, TransferSink& sink) override {
    if (!transfer.file) {
      if (auto error = open(transfer)) return error;
      ResponseHead head;
      head.validator.etag = version_of(transfer.status);
      return deliver_head(id, transfer, std::move(head), static_cast<std::uint64_t>(transfer.status.st_size), sink);
    }
    const std::size_t wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(block_.size(), transfer.end - transfer.next));
    const ssize_t got = ::pread(transfer.file.get(), block_.data(), wanted, static_cast<off_t>(transfer.next));
    if (got < 0 && errno == EINTR) return std::nullopt;
    if (got < 0) return failure(LoadErrorKind::unreadable, std::generic_category().message(errno));
    // Check the version after reading, so that bytes of a newer version are not accepted.
    struct stat status {};
    if (::fstat(transfer.file.get(), &status) != 0 || version_of(status) != version_of(transfer.status) || got == 0)
      return TransferEnd{LoadError{LoadErrorKind::changed, "the file changed while it was read"}, true};
    return deliver(id, transfer, std::span(block_).first(static_cast<std::size_t>(got)), sink);
  }

  std::array<std::byte, std::size_t{128} << 10> block_{};
};

}  // namespace

std::unique_ptr<Transport> make_file_transport() { return std::make_unique<FileTransport>(); }

}  // namespace gs::net
