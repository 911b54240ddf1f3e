#!/bin/sh
# arm.sh FOLDER
# Makes what programs for aarch64 are built and run with, below the folder: root/ has Debian's arm64 packages, unpacked
# and not installed; bin/cc is the cross compiler that takes headers and libraries from root/; bin/run runs a program by
# qemu. apt-get has its lists in the folder, so the machine's own packages and lists stay as they are. Nothing is fetched
# again where the folder is complete.
set -eu
[ -e "$1/complete" ] && exit 0
mkdir -p "$1"
folder=$(cd "$1" && pwd)
root=$folder/root lib=$folder/root/usr/lib/aarch64-linux-gnu
rm -rf "$folder/apt" "$root" "${folder:?}/bin"
mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial" "$root" "$folder/bin"
: >"$folder/apt/status"

apt() {
    apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures::=arm64 -o APT::Sandbox::User= -o Dir::State="$folder/apt" \
        -o Dir::State::status="$folder/apt/status" -o Dir::Cache="$folder/apt/cache" "$@"
}
cd "$folder/apt"
packages='liblapack-dev liblapack3 libblas-dev libblas3 libgfortran5 libsleef-dev libsleef3 check libsubunit-dev'
# shellcheck disable=SC2086 # a list
if ! { apt update && apt download $packages; } >log 2>&1; then
    tail -n 5 log >&2
    echo "Missing, for arm64: $packages. Type, where Debian's packages can be fetched:  make check-arm" >&2
    exit 1
fi
for package in *.deb; do dpkg -x "$package" "$root"; done

# Debian's alternatives are links that installing makes.
for name in lapack blas; do
    ln -s $name/lib$name.so $name/lib$name.so.3 "$lib"
    ln -s $name-netlib.pc "$lib/pkgconfig/$name.pc"
done

# A cross compiler refuses -march=native, which asks for the machine at hand.
cat >"$folder/bin/cc" <<END
#!/bin/sh
for word; do
    shift
    [ "\$word" = -march=native ] || set -- "\$@" "\$word"
done
exec aarch64-linux-gnu-gcc -B$lib -isystem $root/usr/include -isystem $root/usr/include/aarch64-linux-gnu \\
    -Wl,--disable-new-dtags,-rpath,$lib "\$@"
END
cat >"$folder/bin/run" <<END
#!/bin/sh
exec qemu-aarch64 -L /usr/aarch64-linux-gnu "\$@"
END
chmod +x "$folder/bin/cc" "$folder/bin/run"
cd "$folder"
rm -r apt
: >complete
