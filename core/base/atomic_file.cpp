#include "core/base/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <mutex>
#include <set>
#include <streambuf>
#include <system_error>
#include <utility>

#include "core/base/error.hpp"

namespace flowcage {
namespace fs = std::filesystem;
namespace {

/// What must vanish if the process ends early. The second piece of state in core that outlives a call: a
/// signal ends a process, so the list belongs to the process.
struct Unfinished {
  std::mutex mutex;
  std::set<fs::path> paths;
};
Unfinished& unfinished() {
  static Unfinished instance;
  return instance;
}

std::string remedy_for(int code) {
  switch (code) {
    case ENOSPC:
    case EDQUOT:
      return "free space on the disk, or choose another folder with -o";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to";
    case ENOENT:
      return "create the folder first";
    case ENOTDIR:
      return "a part of the path is a file: choose another folder";
    case EISDIR:
      return "it is a folder: give the name of a file";
    case EFBIG:
      return "the limit of a file's size is reached (ulimit -f)";
    case ENAMETOOLONG:
      return "choose a shorter name";
    default:
      return "choose another place with -o";
  }
}

[[noreturn]] void throw_output_error(const std::string& shown_as, int code) {
  throw Error(ErrorKind::output,
              fmt::format("{}: cannot write: {}", shown_as, std::generic_category().message(code)),
              remedy_for(code));
}

/// Calls a function of std::filesystem; its failures become ours.
template <typename Call>
void checked(const std::string& shown_as, const Call& call) {
  try {
    call();
  } catch (const fs::filesystem_error& e) {
    throw_output_error(shown_as, e.code().value());
  }
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// A name in `folder` that no other process or object of this process uses.
fs::path temporary_name(const fs::path& folder, const std::string& extension) {
  static std::atomic<int> counter{0};
  return folder / fmt::format(".flowcage-{}-{}{}", ::getpid(), counter++, extension);
}

/// Where a write to `target` really goes: the end of symbolic links, if they lead somewhere.
fs::path followed(const fs::path& target) {
  std::error_code ignored;
  const fs::path real = fs::canonical(target, ignored);
  return ignored ? target : real;
}

/// A rename survives a crash only once its folder is on the disk; some file systems cannot do it, which is
/// fine.
void sync_folder(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

void sync_file(const fs::path& file, const std::string& shown_as) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) throw_output_error(shown_as, errno);
  const int failure = ::fsync(fd) == 0 ? 0 : errno;
  ::close(fd);
  if (failure != 0) throw_output_error(shown_as, failure);
}

/// Puts the folder `fresh` at `target`, where an older folder may be, which then is at `fresh`.
void exchange_folders(const fs::path& fresh, const fs::path& target, const std::string& shown_as) {
#ifdef RENAME_EXCHANGE
  if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS) throw_output_error(shown_as, errno);
#endif
  // File systems without an exchange: a moment without a folder at the target cannot be avoided.
  const fs::path aside = temporary_name(folder_of(target), "");
  if (::rename(target.c_str(), aside.c_str()) != 0) throw_output_error(shown_as, errno);
  if (::rename(fresh.c_str(), target.c_str()) != 0) {
    const int failure = errno;
    ::rename(aside.c_str(), target.c_str());
    throw_output_error(shown_as, failure);
  }
  ::rename(aside.c_str(), fresh.c_str());
}

}  // namespace

class OutputFile::Buffer : public std::streambuf {
 public:
  Buffer(const fs::path& file, std::string shown_as)
      : shown_as_(std::move(shown_as)),
        // Not O_EXCL: an AtomicFile reserves its name first, and devices exist already.
        fd_(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)),
        bytes_(std::size_t{1} << 18) {
    if (fd_ < 0) throw_output_error(shown_as_, errno);
    setp(bytes_.data(), bytes_.data() + bytes_.size());
  }
  ~Buffer() override {
    if (fd_ >= 0) ::close(fd_);
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  void close() {
    if (fd_ < 0) return;
    flush();
    // EINVAL and ENOTSUP: pipes, terminals and devices cannot be synchronised.
    if (::fsync(fd_) != 0 && errno != EINVAL && errno != ENOTSUP) fail();
    const int fd = std::exchange(fd_, -1);
    if (::close(fd) != 0) throw_output_error(shown_as_, errno);
  }

 protected:
  int_type overflow(int_type c) override {
    flush();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }
  int sync() override {
    flush();
    return 0;
  }
  std::streamsize xsputn(const char* data, std::streamsize count) override {
    if (count > epptr() - pptr()) {
      flush();
      if (count > epptr() - pptr()) {
        write_all(data, count);
        return count;
      }
    }
    std::copy_n(data, count, pptr());
    pbump(static_cast<int>(count));
    return count;
  }

 private:
  void flush() {
    write_all(pbase(), pptr() - pbase());
    setp(bytes_.data(), bytes_.data() + bytes_.size());
  }
  void write_all(const char* data, std::streamsize count) {
    if (fd_ < 0 && count > 0) throw_output_error(shown_as_, EBADF);
    while (count > 0) {
      const ssize_t written = ::write(fd_, data, static_cast<std::size_t>(count));
      if (written < 0) {
        if (errno == EINTR) continue;
        fail();
      }
      data += written;
      count -= written;
    }
  }
  [[noreturn]] void fail() {
    const int code = errno;
    ::close(std::exchange(fd_, -1));
    setp(bytes_.data(), bytes_.data() + bytes_.size());
    throw_output_error(shown_as_, code);
  }

  std::string shown_as_;
  int fd_;
  std::vector<char> bytes_;
};

OutputFile::OutputFile(const fs::path& file, std::string shown_as)
    : std::ostream(nullptr), buffer_(std::make_unique<Buffer>(file, std::move(shown_as))) {
  rdbuf(buffer_.get());
  exceptions(std::ios::badbit);  // the buffer's own exceptions pass through operator<<
}

OutputFile::~OutputFile() = default;

void OutputFile::close() {
  buffer_->close();
}

AtomicFile::AtomicFile(const fs::path& target) : target_(followed(target)), shown_as_(target.string()) {
  struct stat status {};
  const bool exists = ::stat(target_.c_str(), &status) == 0;
  if (!exists && errno != ENOENT) throw_output_error(shown_as_, errno);
  if (exists && S_ISDIR(status.st_mode)) throw_output_error(shown_as_, EISDIR);
  if (target.filename().empty()) throw_output_error(shown_as_, target.empty() ? ENOENT : EISDIR);
  // A file that its owner protected is not replaced, though a rename could.
  if (exists && ::access(target_.c_str(), W_OK) != 0) throw_output_error(shown_as_, errno);
  if (exists && !S_ISREG(status.st_mode)) {
    direct_ = true;
    path_ = target_;
    return;
  }
  path_ = temporary_name(folder_of(target_), target_.extension().string());
  const std::scoped_lock lock(unfinished().mutex);
  const int fd = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) throw_output_error(shown_as_, errno);
  if (exists) ::fchmod(fd, status.st_mode & 07777);  // best effort: keep the older file's permissions
  ::close(fd);
  unfinished().paths.insert(path_);
}

AtomicFile::~AtomicFile() {
  if (direct_ || committed_) return;
  stream_.reset();
  const std::scoped_lock lock(unfinished().mutex);
  std::error_code ignored;
  fs::remove(path_, ignored);
  unfinished().paths.erase(path_);
}

std::ostream& AtomicFile::stream() {
  if (!stream_) stream_ = std::make_unique<OutputFile>(path_, shown_as_);
  return *stream_;
}

void AtomicFile::commit() {
  if (stream_) {
    stream_->close();
  } else if (!direct_) {
    sync_file(path_, shown_as_);
  }
  if (direct_) return;
  const std::scoped_lock lock(unfinished().mutex);
  if (::rename(path_.c_str(), target_.c_str()) != 0) throw_output_error(shown_as_, errno);
  committed_ = true;
  unfinished().paths.erase(path_);
  sync_folder(folder_of(target_));
}

AtomicFolder::AtomicFolder(const fs::path& base, const fs::path& inside, std::vector<std::string> replaced)
    : inside_(inside), shown_as_(base.string()), replaced_(std::move(replaced)) {
  // "case/" and "case" are the same folder.
  const fs::path folder = base.filename().empty() ? base.parent_path() : base;
  if (folder.empty()) throw_output_error(shown_as_, ENOENT);
  target_ = followed(inside.empty() ? folder : folder / inside);
  struct stat status {};
  // The nearest folder that exists is on the file system where the target will be.
  fs::path existing = target_;
  while (::stat(existing.c_str(), &status) != 0) {
    if (errno != ENOENT) throw_output_error(shown_as_, errno);
    if (existing == folder && ::stat(folder_of(folder).c_str(), &status) != 0) {
      throw_output_error(shown_as_, errno);
    }
    existing = folder_of(existing);
  }
  if (!S_ISDIR(status.st_mode)) throw_output_error(shown_as_, ENOTDIR);
  if (existing == target_) existing = folder_of(target_);
  path_ = temporary_name(existing, "");
  const std::scoped_lock lock(unfinished().mutex);
  if (::mkdir(path_.c_str(), 0777) != 0) throw_output_error(shown_as_, errno);
  unfinished().paths.insert(path_);
}

AtomicFolder::~AtomicFolder() {
  if (committed_) return;
  const std::scoped_lock lock(unfinished().mutex);
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  unfinished().paths.erase(path_);
}

std::unique_ptr<OutputFile> AtomicFolder::create(const std::string& name) {
  return std::make_unique<OutputFile>(path_ / name, (fs::path(shown_as_) / inside_ / name).string());
}

void AtomicFolder::commit() {
  const std::scoped_lock lock(unfinished().mutex);
  std::error_code ignored;
  if (fs::is_directory(target_, ignored)) {
    checked(shown_as_, [&] {
      for (const fs::directory_entry& entry : fs::directory_iterator(target_)) {
        const std::string name = entry.path().filename().string();
        if (std::find(replaced_.begin(), replaced_.end(), name) != replaced_.end()) continue;
        if (fs::exists(fs::symlink_status(path_ / name))) continue;
        fs::copy(entry.path(), path_ / name, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
      }
    });
    sync_folder(path_);
    exchange_folders(path_, target_, shown_as_);
    committed_ = true;
    fs::remove_all(path_, ignored);
  } else {
    std::vector<fs::path> made;
    try {
      checked(shown_as_, [&] {
        std::vector<fs::path> missing;
        for (fs::path p = folder_of(target_); !fs::exists(p); p = folder_of(p)) missing.push_back(p);
        for (auto p = missing.rbegin(); p != missing.rend(); ++p) {
          fs::create_directory(*p);
          made.push_back(*p);
        }
        sync_folder(path_);
        fs::rename(path_, target_);
      });
    } catch (...) {
      for (auto p = made.rbegin(); p != made.rend(); ++p) fs::remove(*p, ignored);
      throw;
    }
    committed_ = true;
  }
  unfinished().paths.erase(path_);
  sync_folder(folder_of(target_));
}

void remove_unfinished_outputs() {
  const std::scoped_lock lock(unfinished().mutex);
  for (const fs::path& path : unfinished().paths) {
    // Another thread may still write into a folder: try again until it is empty and gone.
    for (int attempt = 0; attempt < 100; ++attempt) {
      std::error_code failure;
      fs::remove_all(path, failure);
      if (!failure) break;
    }
  }
  unfinished().paths.clear();
}

}  // namespace flowcage
