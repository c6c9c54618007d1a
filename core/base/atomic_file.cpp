#include "base/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/is_there.h"

namespace relamp {
namespace fs = std::filesystem;

void throwWriteFailure(const fs::path& file, int reason, const char* what) {
    const std::string message = fmt::format("{}: {} ({})", file.string(), what, std::strerror(reason));
    if (reason == ENOSPC || reason == EDQUOT || reason == EFBIG) throw OutOfResources(message);
    throw Error(message);
}

void flushFolder(const fs::path& folder) {
    const int handle = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (handle < 0) return;
    ::fsync(handle);
    ::close(handle);
}

fs::path followLinks(const fs::path& path) {
    constexpr int mostLinks = 40;  // as many as the kernel follows
    fs::path at = path;
    for (int link = 0; link < mostLinks; ++link) {
        std::error_code failed;
        const fs::path next = fs::read_symlink(at, failed);
        if (failed) return at;
        at = at.parent_path() / next;
    }
    throw Error("{}: is a circle of links", path.string());
}

fs::path folderPlace(const fs::path& folder) {
    if (folder.empty()) throw Error("the name of a folder is empty");
    std::error_code failed;
    fs::path place = fs::absolute(folder, failed).lexically_normal();
    if (!place.has_filename()) place = place.parent_path();  // a slash at the end
    place = followLinks(place);
    const fs::path real = fs::weakly_canonical(place, failed);
    return failed ? place.lexically_normal() : real;
}

void writeFileAtomically(const fs::path& named, const std::function<void(const fs::path&)>& write) {
    const fs::path target = followLinks(named);
    std::error_code unknown;
    // A rename would put a file in the place of a device.
    if (const fs::file_status there = fs::status(target, unknown); fs::exists(there) && !fs::is_regular_file(there))
        throw Error("{}: is {}, it cannot be written over", named.string(),
                    fs::is_directory(there) ? "a folder" : "no regular file");
    const fs::path temporary =
        target.parent_path() / fmt::format(".{}.{}{}", target.stem().string(), ::getpid(), target.extension().string());
    const auto removeTemporary = [&] {
        std::error_code ignored;
        fs::remove(temporary, ignored);
    };
    try {
        write(temporary);
    } catch (...) {
        removeTemporary();
        throw;
    }
    const auto fail = [&](const char* what) {
        const int reason = errno;
        removeTemporary();
        throwWriteFailure(target, reason, what);
    };
    const int file = ::open(temporary.c_str(), O_RDONLY);
    if (file < 0) fail("cannot be written");
    const bool flushed = ::fsync(file) == 0;
    ::close(file);
    if (!flushed) fail("cannot be flushed to disk");
    if (::rename(temporary.c_str(), target.c_str()) != 0) fail("cannot be put in place");
    flushFolder(target.parent_path());
}

void writeBytesAtomically(const fs::path& target, const std::string& bytes) {
    writeFileAtomically(target, [&](const fs::path& file) {
        errno = 0;
        std::ofstream out(file, std::ios::binary);
        out.write(bytes.data(), std::streamsize(bytes.size()));
        out.flush();
        if (!out) throwWriteFailure(target, errno);
    });
}

std::string readBytes(const fs::path& file, size_t maxBytes) {
    // What is no file may have no end, or none that comes.
    if (!isFile(file)) throw Error("{}: {}", file.string(), whyNoFile(file));
    std::error_code failed;
    const auto size = fs::file_size(file, failed);
    if (failed) throw Error("{}: cannot be read ({})", file.string(), failed.message());
    if (size > maxBytes) throw Error("{}: is {} bytes large, expected at most {}", file.string(), size, maxBytes);
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error("{}: cannot be read ({})", file.string(), std::strerror(errno));
    std::string bytes(size, '\0');
    in.read(bytes.data(), std::streamsize(size));
    if (!in) throw Error("{}: cannot be read", file.string());
    return bytes;
}

}  // namespace relamp
