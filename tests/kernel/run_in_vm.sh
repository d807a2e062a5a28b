#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs a test program in a virtual machine under software emulation, with Debian's kernel and its virtual USB host controller.
# Usage: run_in_vm.sh PROGRAM FOLDER [ARGUMENT ...]; FOLDER keeps the kernel between runs. Exit 0: every test passed, 77: there is no qemu
# or no kernel to be had (said why on stdout), 1: a test failed or the machine did not come to an end.
set -eu
program=$1
work=$2
shift 2
skip() { echo "SKIPPED: $*"; exit 77; }

for tool in qemu-system-x86_64 busybox cpio depmod modprobe dpkg-deb; do
  command -v "$tool" >/dev/null || skip "$tool is not installed (apt-get install qemu-system-x86 busybox-static cpio kmod)"
done
mkdir -p "$work"
cd "$work"

# The kernel's package is unpacked, never installed: it would want to become the kernel of this host.
if [ ! -d kernel/lib/modules ]; then
  package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image/ {print $2; exit}')
  [ -n "$package" ] || skip "apt knows no linux-image-amd64; apt-get update may help"
  apt-get download "$package" >download.log 2>&1 || skip "the package $package cannot be downloaded"
  dpkg-deb -x "$package"_*.deb kernel
  rm -f "$package"_*.deb
fi
version=$(ls kernel/lib/modules | head -n 1)
[ -f "kernel/lib/modules/$version/modules.dep" ] || depmod -b "$PWD/kernel" "$version"

rm -rf root
mkdir -p root/bin root/dev root/proc root/sys root/run root/tmp root/test root/modules
cp "$(command -v busybox)" root/bin/busybox
cp "$program" root/test/program
# Every library that the program needs, at its own place; the loader too.
ldd "$program" | awk '/=> \// {print $3} /^[ \t]*\/.*ld-linux/ {print $1}' | while read -r library; do
  mkdir -p "root$(dirname "$library")"
  cp -L "$library" "root$library"
done
: >root/modules/list
for module in vhci-hcd uvcvideo usbcore; do
  modprobe -d "$PWD/kernel" -S "$version" --show-depends "$module" 2>/dev/null | awk '$1 == "insmod" {print $2}'
done | awk '!seen[$0]++' | while read -r file; do
  cp "$file" root/modules/
  basename "$file" >>root/modules/list
done
cat >root/init <<'INIT'
#!/bin/busybox sh
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t sysfs sys /sys
/bin/busybox mount -t devtmpfs dev /dev
/bin/busybox mount -t tmpfs tmp /tmp
while read -r module; do /bin/busybox insmod "/modules/$module" || echo "insmod $module failed"; done </modules/list
/test/program $(/bin/busybox cat /test/arguments)
echo "TODBENCH-EXIT $?"
/bin/busybox poweroff -f
INIT
sed -i 's|^#!/bin/busybox sh|#!/bin/busybox ash|' root/init
chmod +x root/init
echo "$*" >root/test/arguments
(cd root && find . | cpio -o -H newc --quiet) | gzip -1 >initramfs.gz

# No hardware support is asked for: nested machines seldom have it, and the result must not depend on it.
# It takes a minute or two on an idle host; what takes this long hangs.
timeout 1500 qemu-system-x86_64 -M q35 -accel tcg,thread=multi -cpu max -smp 2 -m 1024 -nographic -no-reboot -net none \
  -kernel kernel/boot/vmlinuz-"$version" -initrd initramfs.gz \
  -append "console=ttyS0 quiet panic=-1 random.trust_cpu=on rdinit=/init" </dev/null >console.log 2>&1 || true
grep -q "TODBENCH-EXIT" console.log || { tail -n 40 console.log; echo "the virtual machine did not come to its end"; exit 1; }
grep -E "^\[ *(RUN|OK|FAILED|PASSED|=+|-+) *\]|Failure|Expected|Actual|Which is|exposure|error|\.cpp:" console.log | tr -d '\r' || true
grep -q "TODBENCH-EXIT 0" console.log
