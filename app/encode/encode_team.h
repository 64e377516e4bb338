#pragma once

#include "base/json_value.h"
#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/shared/stream_sink.h"

#include <memory>
#include <optional>
#include <string>

namespace gs::app {

/// File that the processes of a team write together. Each process writes its own bytes and skips the others.
class TeamFile : public qnv::StreamSink {
 public:
  /// Waits until all processes have written their bytes. Collective; call once. If one process fails, all of them
  /// return its message.
  [[nodiscard]] virtual std::optional<std::string> finish() = 0;
};

/// Team of the processes that run one `encode` command together, as seen from this process.
class EncodeTeam {
 public:
  virtual ~EncodeTeam() = default;

  [[nodiscard]] virtual qnv::Ranks& ranks() = 0;
  /// Returns the number of threads for this process: its share of the cores of its machine.
  [[nodiscard]] virtual unsigned threads() const = 0;
  /// Returns a text that identifies the task by its options, without the contents of its files.
  [[nodiscard]] virtual std::string task() const = 0;
  /// Returns the last error that this process printed, which stays hidden. Empty on rank 0, which shows its errors.
  [[nodiscard]] virtual std::string hidden_errors() const = 0;
  /// Creates the output. Collective. Returns null in all processes if one of them cannot write it.
  [[nodiscard]] virtual std::unique_ptr<TeamFile> create(const std::string& path) = 0;
  /// Returns the numbers of messages and bytes, the memory and the CPU time of each process. Collective.
  [[nodiscard]] virtual JsonValue statistics() = 0;
  /// Notes that all processes end the command now. Without this call, the end of one process ends the others.
  virtual void end_together() = 0;
};

/// Sets the team of this process. It must outlive all commands. Null means that this process encodes alone.
void set_encode_team(EncodeTeam* team);
[[nodiscard]] EncodeTeam* encode_team();

}  // namespace gs::app
