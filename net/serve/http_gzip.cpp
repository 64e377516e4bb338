#include "net/files/file.h"
#include "net/serve/http_site.h"

#include <zlib.h>

#include <cstddef>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

namespace gs::net {

std::optional<MakeFailure> gzip_file(const std::string& source, const std::string& out, const std::stop_token& stop) {
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  const auto opened = open_file(source);
  if (const auto* problem = std::get_if<FileError>(&opened)) return MakeFailure{problem->message, false};
  const auto& file = std::get<RandomAccessFile>(opened);
  const int number = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (number < 0) return MakeFailure{"cannot be written", false};
  const gzFile packed = gzdopen(number, "wb6");
  if (!packed) {
    ::close(number);
    return MakeFailure{"cannot be written", false};
  }
  std::vector<std::byte> piece(kPiece);
  bool good = true;
  for (std::uint64_t at = 0; good && at < file.size();) {
    const std::size_t got = file.read(at, piece);
    good = got > 0 && !stop.stop_requested() &&
           gzwrite(packed, piece.data(), static_cast<unsigned>(got)) == static_cast<int>(got);
    at += got;
  }
  if (gzclose(packed) != Z_OK || !good) return MakeFailure{"cannot be compressed", false};
  return std::nullopt;
}

}  // namespace gs::net
