#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::net {

/// Kinds of frames of a tunnel (docs/decisions/0050). Readers ignore other kinds.
enum class TunnelFrameKind : std::uint8_t {
  hello = 1,   // lines "KEY VALUE": protocols, version, features
  open = 2,    // the client opens a connection
  data = 3,    // bytes of a connection
  window = 4,  // number of further bytes of the connection that the sender of this frame accepts
  close = 5,   // the sender sends no more data of the connection, and takes none
  error = 6,   // the connection is gone, or the whole tunnel if the connection is 0; a text states the reason
  ping = 7,    // the receiver returns the payload in a pong
  pong = 8
};

/// Frame of a tunnel. Its payload is valid until the next call of the reader.
struct TunnelFrame {
  TunnelFrameKind kind{};
  std::uint32_t connection = 0;
  std::span<const std::byte> payload;
};

inline constexpr std::size_t kTunnelHeader = 9;  // payload size (4 bytes), kind (1), connection (4); big-endian
inline constexpr std::size_t kMaxTunnelPayload = std::size_t{64} << 10;
/// Bytes that precede the frames of each direction. A login shell may print text before them.
inline constexpr std::string_view kTunnelMark{"\0GhostSpace tunnel\n", 19};
/// Maximum bytes before the mark.
inline constexpr std::size_t kMaxTunnelNoise = std::size_t{64} << 10;

/// Appends a frame to `out`. The payload must not exceed kMaxTunnelPayload.
void append_frame(std::vector<std::byte>& out, TunnelFrameKind kind, std::uint32_t connection,
                  std::span<const std::byte> payload = {});
void append_frame(std::vector<std::byte>& out, TunnelFrameKind kind, std::uint32_t connection, std::string_view text);
void append_frame(std::vector<std::byte>& out, TunnelFrameKind kind, std::uint32_t connection, std::uint32_t number);
/// Reads the number in the payload of a window frame. Returns nullopt if the payload has another size.
[[nodiscard]] std::optional<std::uint32_t> number_of(const TunnelFrame& frame);

/// Splits received bytes into frames. Holds at most one frame.
class TunnelFrameReader {
 public:
  /// Appends received bytes. Returns an error if they cannot be those of a tunnel.
  [[nodiscard]] std::optional<std::string> receive(std::span<const std::byte> bytes);
  /// Returns the next complete frame, or nullopt.
  [[nodiscard]] std::optional<TunnelFrame> next();
  /// Reports whether the mark was received.
  [[nodiscard]] bool marked() const { return marked_; }

 private:
  bool find_mark();

  std::vector<std::byte> bytes_;
  std::size_t begin_ = 0;  // offset of the first unread byte
  std::size_t noise_ = 0;  // bytes before the mark that were dropped
  bool marked_ = false;
};

/// Content of a hello. Unknown keys are ignored.
struct TunnelHello {
  std::vector<unsigned> protocols;  // supported versions
  std::string version;              // version of the program, for messages
  std::vector<std::string> features;
};
inline constexpr unsigned kTunnelProtocol = 1;
[[nodiscard]] std::string hello_text(const TunnelHello& hello);
[[nodiscard]] TunnelHello parse_hello(std::string_view text);

}  // namespace gs::net
