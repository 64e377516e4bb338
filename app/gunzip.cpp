#include "app/gunzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace gs::app {
namespace {

constexpr std::size_t kPiece = std::size_t{256} << 10;
constexpr int kGzipWindow = 15 + 16;  // zlib: the largest window, gzip framing

}  // namespace

bool is_gzip(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b};
}

std::optional<std::string> gunzip(std::span<const std::byte> bytes, std::size_t limit,
                                  const std::function<bool(std::string_view)>& sink) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzipWindow) != Z_OK) return "zlib could not be set up";
  std::vector<char> piece(kPiece);
  std::size_t total = 0, next = 0;
  std::optional<std::string> problem;
  for (bool running = true; running;) {
    const std::size_t given = std::min<std::size_t>(bytes.size() - next, std::numeric_limits<uInt>::max());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data() + next));
    stream.avail_in = static_cast<uInt>(given);
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    const int status = inflate(&stream, Z_NO_FLUSH);
    next += given - stream.avail_in;
    const std::size_t made = piece.size() - stream.avail_out;
    total += made;
    if (total > limit) {
      problem = "unpacks to more than " + std::to_string(limit) + " bytes";
      break;
    }
    if (made > 0 && !sink(std::string_view(piece.data(), made))) break;
    switch (status) {
      case Z_STREAM_END:
        // Another member may follow (RFC 1952 2.2); anything else behind the last one is ignored.
        running = is_gzip(bytes.subspan(next)) && inflateReset(&stream) == Z_OK;
        break;
      case Z_OK:
        break;
      case Z_BUF_ERROR:
        if (next == bytes.size()) {
          problem = "the gzip data ends too early";
          running = false;
        }
        break;
      default:
        problem = std::string("the gzip data is damaged") + (stream.msg ? std::string(" (") + stream.msg + ")" : "");
        running = false;
        break;
    }
  }
  inflateEnd(&stream);
  return problem;
}

}  // namespace gs::app
