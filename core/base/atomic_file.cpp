#include "base/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/error.h"

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

void writeFileAtomically(const fs::path& target, const std::function<void(const fs::path&)>& write) {
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
    std::error_code failed;
    const auto size = fs::file_size(file, failed);
    if (failed) throw Error("{}: cannot be read ({})", file.string(), failed.message());
    if (size > maxBytes) throw Error("{}: is {} bytes large, expected at most {}", file.string(), size, maxBytes);
    std::ifstream in(file, std::ios::binary);
    std::string bytes(size, '\0');
    in.read(bytes.data(), std::streamsize(size));
    if (!in) throw Error("{}: cannot be read", file.string());
    return bytes;
}

}  // namespace relamp
