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

/// Names one transfer of one transport; given by the engine.
using TransferId = std::uint64_t;

/// One attempt to get one range of one resource.
struct TransferRequest {
  std::string url;                 // without fragment, but for data:
  std::optional<ByteRange> range;  // none: the whole; the end may be open
  std::string if_range;            // the range only if the resource is still this version, else the whole
  std::string if_none_match;       // status 304 if the resource still is this version
  std::string if_modified_since;   // the same by date
  std::string accept;
  AddressSpace reach = AddressSpace::special;  // the most private space in which the host may be
};

/// How a transfer ended. Without error the whole announced body has been handed over.
struct TransferEnd {
  std::optional<LoadError> error;  // its message without the URL
  bool transient = false;          // another attempt may go better
};

enum class HeadVerdict { take, discard, stop };  // discard: read a short body and drop it, so that the connection lives
enum class DataVerdict { more, pause, stop };    // pause: these bytes were taken, but no more until unpaused

/// Who hears of transfers. Called from within Transport::step only. After `stop` nothing more comes, no end either.
class TransferSink {
 public:
  virtual HeadVerdict on_head(TransferId id, const ResponseHead& head) = 0;
  virtual DataVerdict on_data(TransferId id, std::span<const std::byte> bytes) = 0;
  virtual void on_end(TransferId id, const TransferEnd& end) = 0;

 protected:
  ~TransferSink() = default;
};

/// Carries bytes for some schemes. Lives on one thread; never blocks it but for what a disk takes.
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// Begins a transfer. Never from within a call of the sink.
  virtual void start(TransferId id, const TransferRequest& request, TimePoint now) = 0;
  /// Nothing more comes of this transfer. Also from within a call of the sink; unknown ids are passed over.
  virtual void cancel(TransferId id) = 0;
  /// Holds a transfer back or lets it go on. Also from within a call of the sink.
  virtual void pause(TransferId id, bool paused) = 0;
  /// Moves on whatever can move and tells the sink.
  virtual void step(TransferSink& sink, TimePoint now) = 0;
  /// When step() should be called next, whatever sockets say; nothing: no need.
  [[nodiscard]] virtual std::optional<TimePoint> deadline(TimePoint now) const = 0;
  /// Sockets whose bytes should end the wait for the next step.
  [[nodiscard]] virtual std::vector<int> readable() const { return {}; }
};

/// What a loader thread waits on.
class Waiter {
 public:
  Waiter() = default;
  Waiter(const Waiter&) = delete;
  Waiter& operator=(const Waiter&) = delete;
  virtual ~Waiter() = default;
  /// Until `time` passed, a socket is ready, or wake() was called, even before.
  virtual void wait(Milliseconds time, std::span<const int> readable) = 0;
  /// Any thread.
  virtual void wake() = 0;
};

/// http, https and ftp, by libcurl; also waits for its own sockets.
class HttpTransport : public Transport, public Waiter {
 public:
  /// Of all transfers together from the next step on, bytes a second; 0: any. Any thread.
  virtual void set_rate(std::uint64_t bytes_per_second) = 0;
};

/// Null where libcurl cannot be opened; curl().problem says why.
[[nodiscard]] std::unique_ptr<HttpTransport> make_http_transport(const LoaderOptions& options);
[[nodiscard]] std::unique_ptr<Transport> make_file_transport();
[[nodiscard]] std::unique_ptr<Transport> make_data_transport();
/// RFC 2397, leniently: blanks in base64 and missing padding are passed over. A fragment is dropped, but for data that
/// begins with a '#' (worlds do).
struct DataUrl {
  std::string media_type;
  std::vector<std::byte> bytes;
};
[[nodiscard]] std::optional<DataUrl> decode_data_url(std::string_view url);

}  // namespace gs::net
