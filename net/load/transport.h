#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "net/load/load_types.h"

namespace gs::net {

/// Identifier of a transfer of one transport, given by the engine.
using TransferId = std::uint64_t;

/// Attempt to get one range of one resource.
struct TransferRequest {
  std::string url;                 // without fragment, except for data:
  std::optional<ByteRange> range;  // nullopt means the whole; the end may be open
  std::string if_range;            // request the range only if the resource still has this version, else the whole
  std::string if_none_match;       // request status 304 if the resource still has this version
  std::string if_modified_since;   // request status 304 if the resource has not changed since this date
  std::string accept;
  AddressSpace reach = AddressSpace::special;  // the most private space in which the host may be
};

/// Result of a transfer. Without error, the whole announced body was delivered.
struct TransferEnd {
  std::optional<LoadError> error;  // message without the URL
  bool transient = false;          // another attempt may succeed
};

// discard: read and drop a short body, so that the connection stays usable.
enum class HeadVerdict { take, discard, stop };
enum class DataVerdict { more, pause, stop };  // pause: these bytes were taken; send no more until unpaused

/// Receiver of the results of transfers. Called from Transport::step only. After `stop`, nothing follows, not even an
/// end.
class TransferSink {
 public:
  virtual HeadVerdict on_head(TransferId id, const ResponseHead& head) = 0;
  virtual DataVerdict on_data(TransferId id, std::span<const std::byte> bytes) = 0;
  virtual void on_end(TransferId id, const TransferEnd& end) = 0;

 protected:
  ~TransferSink() = default;
};

/// Carries the bytes of some schemes. Lives on one thread, and blocks it only for disk reads.
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// Begins a transfer. Must not be called from a call of the sink.
  virtual void start(TransferId id, const TransferRequest& request, TimePoint now) = 0;
  /// Ends a transfer without further calls of the sink. May be called from a call of the sink. Ignores unknown ids.
  virtual void cancel(TransferId id) = 0;
  /// Pauses or continues a transfer. May be called from a call of the sink.
  virtual void pause(TransferId id, bool paused) = 0;
  /// Advances all transfers and calls the sink.
  virtual void step(TransferSink& sink, TimePoint now) = 0;
  /// Returns the time of the next call of step(), regardless of sockets; nullopt means that none is needed.
  [[nodiscard]] virtual std::optional<TimePoint> deadline(TimePoint now) const = 0;
  /// Returns the sockets that end the wait for the next step when they are readable.
  [[nodiscard]] virtual std::vector<int> readable() const { return {}; }
};

/// Wait of a loader thread.
class Waiter {
 public:
  Waiter() = default;
  Waiter(const Waiter&) = delete;
  Waiter& operator=(const Waiter&) = delete;
  virtual ~Waiter() = default;
  /// Waits until `time` has passed, a socket is ready, or wake() is called, even before this call.
  virtual void wait(Milliseconds time, std::span<const int> readable) = 0;
  /// Ends the wait. Any thread.
  virtual void wake() = 0;
};

/// Transport for http, https and ftp by libcurl. Also waits for its own sockets.
class HttpTransport : public Transport, public Waiter {
 public:
  /// Limits the total bandwidth in bytes per second from the next step; 0 means unlimited. Any thread.
  virtual void set_rate(std::uint64_t bytes_per_second) = 0;
};

/// Returns null if libcurl cannot be opened; curl().problem has the reason.
[[nodiscard]] std::unique_ptr<HttpTransport> make_http_transport(const LoaderOptions& options);
[[nodiscard]] std::unique_ptr<Transport> make_file_transport();
[[nodiscard]] std::unique_ptr<Transport> make_data_transport();
/// Parsed data: URL (RFC 2397). Blanks in base64 and missing padding are allowed. A fragment is dropped, except in data
/// that begin with '#', as worlds do.
struct DataUrl {
  std::string media_type;
  std::vector<std::byte> bytes;
};
[[nodiscard]] std::optional<DataUrl> decode_data_url(std::string_view url);

}  // namespace gs::net
