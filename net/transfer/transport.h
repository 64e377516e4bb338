#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/noncopyable.h"
#include "net/transfer/load_types.h"

namespace gs::net {

/// Identifier of a transfer, chosen by the engine. Unique in a transport.
using TransferId = std::uint64_t;

/// Attempt to load one range of one resource.
struct TransferRequest {
  std::string url;                 // has a fragment only if the scheme is data:
  std::optional<ByteRange> range;  // nullopt means the whole resource; the range may have an open end
  std::string if_range;            // send the range only if this version is current, else everything
  std::string if_none_match;       // request status 304 if the resource still has this version
  std::string if_modified_since;   // request status 304 if the resource has not changed since this date
  std::string accept;
  bool post = false;                           // as Request::post
  std::string authorization;                   // as Request::authorization
  AddressSpace reach = AddressSpace::special;  // most private space in which the host may be
  std::string within;  // ssh: path of the folder that links in the path must not leave; empty means no limit
};

/// Result of a transfer. Without an error, the whole announced body was delivered.
struct TransferEnd {
  std::optional<LoadError> error;  // the message does not contain the URL
  bool transient = false;          // another attempt may succeed
};

// Answer to a head. `discard` reads and drops a short body, so that the connection can be reused.
enum class HeadVerdict { take, discard, stop };
enum class DataVerdict { more, pause, stop };  // pause: the data is taken; deliver no more until unpaused

/// Receiver of the results of transfers. Only Transport::step calls it. After an answer `stop`, no more calls follow
/// for that transfer, not even on_end.
class TransferSink {
 public:
  virtual HeadVerdict on_head(TransferId id, const ResponseHead& head) = 0;
  virtual DataVerdict on_data(TransferId id, std::span<const std::byte> bytes) = 0;
  virtual void on_end(TransferId id, const TransferEnd& end) = 0;

 protected:
  ~TransferSink() = default;
};

/// Transport for the URLs of some schemes. Runs on one thread. Blocks only for disk reads.
class Transport : NonCopyable {
 public:
  virtual ~Transport() = default;

  /// Starts a transfer. Must not be called by a function of the sink.
  virtual void start(TransferId id, const TransferRequest& request, TimePoint now) = 0;
  /// Ends a transfer without further calls of the sink. The sink may call it. Ignores unknown ids.
  virtual void cancel(TransferId id) = 0;
  /// Pauses or resumes a transfer. The sink may call it.
  virtual void pause(TransferId id, bool paused) = 0;
  /// Advances all transfers and calls the sink.
  virtual void step(TransferSink& sink, TimePoint now) = 0;
  /// Returns the time by which step() must be called even if no socket is ready. Nullopt means never.
  [[nodiscard]] virtual std::optional<TimePoint> deadline(TimePoint now) const = 0;
  /// Returns sockets. If one is readable, step() must be called.
  [[nodiscard]] virtual std::vector<int> readable() const { return {}; }
};

/// Interruptible wait of a loader thread.
class Waiter : NonCopyable {
 public:
  virtual ~Waiter() = default;
  /// Waits until `time` has passed, a socket is readable, or wake() is called. Returns at once if wake() was called
  /// before.
  virtual void wait(Milliseconds time, std::span<const int> readable) = 0;
  /// Ends the wait, or the next wait. Any thread.
  virtual void wake() = 0;
};

/// Transport for http, https, ftp and ssh by libcurl. As a Waiter, it also waits for its own sockets.
class HttpTransport : public Transport, public Waiter {
 public:
  /// Limits the total bandwidth in bytes per second from the next step; 0 means unlimited. Any thread.
  virtual void set_rate(std::uint64_t bytes_per_second) = 0;
};

/// Makes the transport. Returns null if libcurl cannot be loaded; curl().problem has the reason.
[[nodiscard]] std::unique_ptr<HttpTransport> make_http_transport(const LoaderOptions& options);
[[nodiscard]] std::unique_ptr<Transport> make_file_transport();
[[nodiscard]] std::unique_ptr<Transport> make_data_transport();
/// Parsed data: URL (RFC 2397). Base64 may contain blanks and lack padding. The fragment is dropped, except in data
/// that begins with '#', such as VRML files.
struct DataUrl {
  std::string media_type;
  std::vector<std::byte> bytes;
};
[[nodiscard]] std::optional<DataUrl> decode_data_url(std::string_view url);

}  // namespace gs::net
