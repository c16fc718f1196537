#pragma once
#include <filesystem>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace flowcage {

/// Outputs appear whole or not at all: they are written under a temporary name in the same file system,
/// brought to the disk (fsync) and renamed. An older output stays intact until then and on any failure; the
/// destructor removes what was not committed. All failures are Error(output) with the name as the user gave
/// it and the system's reason. POSIX.

/// A file stream whose failures are exceptions: a full disk throws out of operator<<, `close` or `write`.
class OutputFile : public std::ostream {
 public:
  /// Opens (creates or truncates) `file`; messages call it `shown_as`.
  OutputFile(const std::filesystem::path& file, std::string shown_as);
  ~OutputFile() override;  ///< closes; use `close` to learn of errors
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Flushes, brings the bytes to the disk and closes. Nothing may be written afterwards.
  void close();

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
};

/// One file. Construct it before long work: whether the place can be written shows at once.
/// A target that exists and is no regular file (/dev/stdout, a pipe) is written directly.
class AtomicFile {
 public:
  /// Throws Error(output) if the folder does not exist or cannot be written, or the target is a folder.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// The stream to write to, opened at the first call.
  std::ostream& stream();
  /// For writers of other libraries that want a file name: it has the target's extension. Do not mix with
  /// stream().
  const std::filesystem::path& path() const { return path_; }
  /// Brings the file to its place. Call once, after everything was written.
  void commit();

 private:
  std::filesystem::path target_, path_;
  std::string shown_as_;
  bool direct_ = false;
  bool committed_ = false;
  std::unique_ptr<OutputFile> stream_;
};

/// A folder below a folder of the user's, for example constant/polyMesh below a case folder. Other files of
/// the user's folder are never touched.
class AtomicFolder {
 public:
  /// `base` may exist or not, its parent must exist; `inside` is relative to it (may be empty: base itself).
  /// `replaced` names the entries that an older folder of that name gives up; its other entries (a user's
  /// blockMeshDict in polyMesh) are carried over.
  AtomicFolder(const std::filesystem::path& base, const std::filesystem::path& inside,
               std::vector<std::string> replaced);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// A new file in the folder; close it before commit. Several may be written at once.
  std::unique_ptr<OutputFile> create(const std::string& name);
  /// The temporary folder.
  const std::filesystem::path& path() const { return path_; }
  /// Swaps the folder in, and makes missing folders between base and it. Call once.
  void commit();

 private:
  std::filesystem::path target_, path_, inside_;
  std::string shown_as_;
  std::vector<std::string> replaced_;
  bool committed_ = false;
};

/// Removes every temporary file and folder of this process that was not committed; waits for a commit that is
/// under way. For a program that must end at once (a second Ctrl-C); objects above must not be used
/// afterwards.
void remove_unfinished_outputs();

}  // namespace flowcage
