#pragma once

#include "app/session/documents/session_log.h"
#include "app/session/documents/world_reader.h"
#include "app/session/opening/data_choices.h"
#include "app/session/opening/follower.h"
#include "app/session/opening/link_follower.h"
#include "app/session/opening/series_playback.h"
#include "app/session/opening/session_questions.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "base/noncopyable.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gs::render {
class MeshWorker;
}

namespace gs::app {

/// Parts of a session that are informed about files that were read.
struct ReaderPeers {
  SessionLog& log;
  SessionQuestions& questions;
  SeriesList& series;
  LinkFollower& links;
  DataChoices& data;
  Follower& follower;
};

/// Reader that starts before the session, while the window opens.
struct EarlyReader {
  std::string path;
  VoxelComponent data;                  // options of the reading
  std::size_t memory = 0;               // memory limit of the reading, in bytes
  std::shared_ptr<WorldReader> reader;  // null after use
};
/// Starts reading a file for the first viewport of a session with the options `load`. The reader calls `wake`, which
/// must be thread-safe. Returns null for local files, for URLs with a fragment, and with --follow.
[[nodiscard]] std::shared_ptr<EarlyReader> read_early(const std::string& path, const LoadOptions& load,
                                                      std::function<void()> wake);

/// Reader threads for the files that viewports show or wait for. One thread.
class DocumentReaders : NonCopyable {
 public:
  /// Prepares the readers without creating a thread. Reader threads call `wake` when take_news() has something to
  /// apply. `meshes` makes the meshes of changed geometry in the background; if null, they are made at once.
  DocumentReaders(StepContext& step, SessionViewports& viewports, const LoadOptions& load, ReaderPeers peers,
                  std::function<void()> wake, std::shared_ptr<render::MeshWorker> meshes);
  /// Cancels all readings and waits for their threads.
  ~DocumentReaders();

  /// Sets a reader for the first reading. The session uses it if file and options match, else cancels it.
  void use(std::shared_ptr<EarlyReader> early) { early_ = std::move(early); }
  /// Starts readers for files that viewports wait for.
  void begin();
  /// Applies the news of all readers. Returns true if a picture or the progress changed.
  bool take_news();
  /// Takes the meshes that were finished in the background for any world. Returns true if a picture changed.
  bool take_meshes();
  /// Shows a running world that another part of the program opened, in the active viewport.
  void show(std::shared_ptr<Document> document);
  /// Stops loading the file of a visible viewport. `place` is an index into Panes::visible().
  void cancel(std::size_t place);

  /// Returns true if the file of a visible viewport is still loading.
  [[nodiscard]] bool loading() const;
  /// Returns the progress of each reading of a file.
  [[nodiscard]] std::vector<LoadingState> progress_of(const std::string& path) const;
  /// Load ledger of a world that is open or being read.
  struct Loads {
    std::string path;                    // path or URL of the world
    std::shared_ptr<Document> document;  // null until the file is read
    std::shared_ptr<LoadLedger> ledger;
  };
  /// Returns the load ledgers of all worlds, including the worlds that failed most recently.
  [[nodiscard]] std::vector<Loads> loads() const;

 private:
  /// Reading and its thread.
  struct Reader {
    DocumentList::Reading reading;
    std::shared_ptr<WorldReader> reader;
    VoxelComponent data;
    LoadingState state;
  };

  [[nodiscard]] bool use_early(DocumentList::Reading& reading, const LoadOptions& load);
  bool take_document(const Reader& from, WorldReader::News& news);
  bool apply_updates(Document& document, const std::string& path, WorldReader::News news);
  void note_empty(const Document& document, const std::string& path);
  void show_failed(std::uint64_t reading, const std::string& path, const Diagnostics& diagnostics);

  StepContext& step_;
  SessionViewports& viewports_;
  const LoadOptions& load_;
  ReaderPeers peers_;
  std::function<void()> wake_;
  std::shared_ptr<render::MeshWorker> meshes_;  // null in simulated time, where meshes are made at once
  std::shared_ptr<EarlyReader> early_;
  std::vector<Reader> readers_;
  std::vector<std::shared_ptr<WorldReader>> retired_;  // readers that are no longer needed and are ending their threads
  std::vector<Loads> failed_loads_;
};

}  // namespace gs::app
