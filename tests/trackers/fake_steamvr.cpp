// A stand-in for SteamVR's client library: what the package openvr loads in its place. It tells the poses of a PoseFeed
// (mitl/trackers/pose_feed.py), whose file the environment variable MITL_POSE_FEED names. Written from the documented binary interface:
// a factory for IVRClientCore_003, and IVRSystem_023 as a table of 47 functions.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

struct Header { char magic[8]; uint64_t session; volatile uint64_t quitting; double latency; uint64_t devices; char rest[24]; };
struct Device { char serial[32]; char model[32]; uint32_t kind; uint32_t role; char rest[8]; volatile uint64_t written; char rest2[8]; };
struct Slot { double time; float matrix[12]; float velocity[3]; int32_t result; uint32_t flags; uint32_t rest; uint64_t buttons; };
constexpr int kDevices = 8, kSlots = 1024;
struct Feed { Header header; Device device[kDevices]; Slot slot[kDevices][kSlots]; };
static_assert(sizeof(Header) == 64 && sizeof(Device) == 96 && sizeof(Slot) == 88, "as PoseFeed writes it");

struct Pose { float matrix[12]; float velocity[3]; float turning[3]; int32_t result; uint8_t valid; uint8_t connected; uint8_t rest[2]; };
static_assert(sizeof(Pose) == 80, "TrackedDevicePose_t");
#pragma pack(push, 4)
struct State { uint32_t packet; uint64_t pressed; uint64_t touched; float axes[10]; };
struct Event { uint32_t type; uint32_t device; float age; unsigned char data[64]; };
#pragma pack(pop)
static_assert(sizeof(State) == 60, "VRControllerState_t on Linux");

Feed* feed = nullptr;
bool quit_told = false;
constexpr double kStale = 2.0;  // seconds without a sample after which a device counts as gone
constexpr int kInitOk = 0, kNoServer = 121, kQuit = 700, kPropertyOk = 0, kUnknownProperty = 9, kTooSmall = 3;

double now() { timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return t.tv_sec + 1e-9 * t.tv_nsec; }

// The newest sample that was due `latency` ago; false where there is none or it is stale.
bool sample(uint32_t index, Slot& out) {
  if (!feed || index >= feed->header.devices) return false;
  const double due = now() - feed->header.latency;
  const uint64_t written = __atomic_load_n(&feed->device[index].written, __ATOMIC_ACQUIRE);
  for (uint64_t back = 1; back <= written && back < kSlots; ++back) {
    out = feed->slot[index][(written - back) % kSlots];
    if (out.time <= due) return due - out.time < kStale;
  }
  return false;
}

void pose_of(uint32_t index, Pose* pose) {
  std::memset(pose, 0, sizeof *pose);
  Slot slot;
  if (feed->header.quitting || !sample(index, slot)) { pose->result = 1; return; }
  std::memcpy(pose->matrix, slot.matrix, sizeof slot.matrix);
  std::memcpy(pose->velocity, slot.velocity, sizeof slot.velocity);
  pose->result = slot.result;
  pose->valid = slot.flags & 1;
  pose->connected = slot.flags >> 1 & 1;
}

void get_poses(int, float, Pose* poses, uint32_t count) { for (uint32_t i = 0; i < count; ++i) pose_of(i, poses + i); }
int32_t device_class(uint32_t index) { return index < feed->header.devices ? int32_t(feed->device[index].kind) : 0; }
int32_t role(uint32_t index) { return index < feed->header.devices ? int32_t(feed->device[index].role) : 0; }
uint8_t connected(uint32_t index) { Slot slot; return !feed->header.quitting && sample(index, slot); }

uint32_t string_property(uint32_t index, int32_t property, char* value, uint32_t size, int32_t* error) {
  const char* text = index >= feed->header.devices ? nullptr
      : property == 1000 ? "lighthouse" : property == 1001 ? feed->device[index].model : property == 1002 ? feed->device[index].serial : nullptr;
  if (!text) { if (error) *error = kUnknownProperty; return 0; }
  const uint32_t needed = std::strlen(text) + 1;
  if (size < needed) { if (error) *error = kTooSmall; return needed; }
  std::memcpy(value, text, needed);
  if (error) *error = kPropertyOk;
  return needed;
}

uint8_t state(uint32_t index, State* out, uint32_t size) {
  Slot slot;
  if (size != sizeof(State) || feed->header.quitting || !sample(index, slot)) return 0;
  std::memset(out, 0, sizeof *out);
  out->pressed = slot.buttons;
  out->packet = uint32_t(feed->device[index].written);
  return 1;
}
uint8_t state_with_pose(int, uint32_t index, State* out, uint32_t size, Pose* pose) { pose_of(index, pose); return state(index, out, size); }

uint8_t poll(void* event, uint32_t) {
  if (!feed->header.quitting || quit_told) return 0;
  quit_told = true;
  std::memset(event, 0, 16);
  std::memcpy(event, &kQuit, 4);
  return 1;
}
const char* name(int32_t) { return "unknown"; }
const char* version() { return "mitl stand-in 1"; }
void unused() { std::fprintf(stderr, "the stand-in for SteamVR was asked for a function that it does not have\n"); std::abort(); }

void* table[47];
void fill_table() {
  for (auto& entry : table) entry = reinterpret_cast<void*>(unused);
  table[11] = reinterpret_cast<void*>(get_poses);
  table[18] = reinterpret_cast<void*>(role);
  table[19] = reinterpret_cast<void*>(device_class);
  table[20] = reinterpret_cast<void*>(connected);
  table[27] = reinterpret_cast<void*>(string_property);
  table[28] = reinterpret_cast<void*>(name);
  table[29] = reinterpret_cast<void*>(poll);
  table[32] = reinterpret_cast<void*>(name);
  table[34] = reinterpret_cast<void*>(state);
  table[35] = reinterpret_cast<void*>(state_with_pose);
  table[46] = reinterpret_cast<void*>(version);
}

struct ClientCore {
  virtual int32_t Init(int32_t, const char*) {
    const char* path = std::getenv("MITL_POSE_FEED");
    const int file = path ? open(path, O_RDONLY) : -1;
    struct stat found;
    if (file < 0 || fstat(file, &found) != 0 || found.st_size != off_t(sizeof(Feed))) { if (file >= 0) close(file); return kNoServer; }
    void* mapped = mmap(nullptr, sizeof(Feed), PROT_READ, MAP_SHARED, file, 0);
    close(file);
    if (mapped == MAP_FAILED) return kNoServer;
    feed = static_cast<Feed*>(mapped);
    if (std::memcmp(feed->header.magic, "MITLVR1", 8) != 0 || feed->header.quitting) { Cleanup(); return kNoServer; }
    quit_told = false;
    fill_table();
    return kInitOk;
  }
  virtual void Cleanup() { if (feed) munmap(feed, sizeof(Feed)); feed = nullptr; }
  virtual int32_t IsInterfaceVersionValid(const char* wanted) { return std::strcmp(wanted, "IVRSystem_023") == 0 ? kInitOk : 105; }
  virtual void* GetGenericInterface(const char* wanted, int32_t* error) {
    const bool known = std::strcmp(wanted, "FnTable:IVRSystem_023") == 0;
    if (error) *error = known ? kInitOk : 105;
    return known ? table : nullptr;
  }
  virtual bool BIsHmdPresent() { return false; }
  virtual const char* GetEnglishStringForHmdError(int32_t) { return "no server"; }
  virtual const char* GetIDForVRInitError(int32_t) { return "VRInitError_Init_NoServerForBackgroundApp"; }
} core;

}  // namespace

extern "C" __attribute__((visibility("default"))) void* VRClientCoreFactory(const char* wanted, int* error) {
  const bool known = std::strcmp(wanted, "IVRClientCore_003") == 0;
  if (error) *error = known ? kInitOk : 105;
  return known ? &core : nullptr;
}
