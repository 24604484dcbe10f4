#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A plan executed over ssh on two logins of this machine gives the same store as without, also if a worker and the calling
# program are killed, and with a recorded sequence that the hosts lack.   ssh_test.sh PROGRAM
source "$(dirname "${BASH_SOURCE[0]}")/cluster.sh" "$1" sshd ssh ssh-keygen parallel rsync

port="$(free_port)"
ssh-keygen -q -t ed25519 -N "" -f "$work/host_key"
ssh-keygen -q -t ed25519 -N "" -f "$work/key"
cp "$work/key.pub" "$work/authorized_keys"
# Each login has a home of its own, so that the two are like two machines.
mkdir -p "$work/home/one" "$work/home/two"
cat >"$work/login.sh" <<LOGIN
#!/bin/sh
export HOME="$work/home/\$LOGIN_NAME" STILLPOINT_CACHE="$work/cache" STILLPOINT_REGISTRY="$work/none.json"
cd "\$HOME" && exec /bin/sh -c "\$SSH_ORIGINAL_COMMAND"
LOGIN
chmod 700 "$work/login.sh"
cat >"$work/sshd_config" <<CONF
Port $port
ListenAddress 127.0.0.1
HostKey $work/host_key
AuthorizedKeysFile $work/authorized_keys
PidFile $work/sshd.pid
PasswordAuthentication no
KbdInteractiveAuthentication no
UsePAM no
StrictModes no
AcceptEnv LOGIN_NAME
ForceCommand $work/login.sh
MaxStartups 100
CONF
for login in one two; do
  cat <<CONF
Host $login
  HostName 127.0.0.1
  Port $port
  User $(id -un)
  IdentityFile $work/key
  IdentitiesOnly yes
  UserKnownHostsFile $work/known_hosts
  StrictHostKeyChecking accept-new
  SetEnv LOGIN_NAME=$login
  LogLevel ERROR
CONF
done >"$work/ssh_config"
printf 'Host absent\n  HostName 127.0.0.1\n  Port %s\n' "$(free_port)" >>"$work/ssh_config"
printf 'one program=%s\n# the same machine by another name\ntwo tasks=1\n' "$(realpath "$program")" >"$work/hosts"
# sshd separates privileges in a folder that its service would create
if ((EUID == 0)) && mkdir /run/sshd 2>/dev/null; then before_stop() { rmdir /run/sshd; }; fi
start sshd "$(command -v sshd)" -D -e -f "$work/sshd_config"
login() { ssh -F "$work/ssh_config" -oBatchMode=yes "$1" -- true; }
wait_until 20 login one
wait_until 20 login two
by_ssh=(--executor ssh --hosts "$work/hosts" --ssh-config "$work/ssh_config" --tasks 4)

write_plan plan 2
bench plan local --jobs 2 || fail "local execution: $(tail -n 3 "$work/bench-local.log")"
bench plan ssh "${by_ssh[@]}" || fail "execution over ssh: $(tail -n 3 "$work/bench-ssh.log")"
grep -q '4 tasks on 2 hosts' "$work/bench-ssh.log" || fail "not 4 tasks on 2 hosts"
for login in one two; do
  compgen -G "$work/home/$login/.stillpoint/jobs/*/store-*.sqlite" >/dev/null || fail "host $login executed nothing"
done
expect_equal local ssh
echo "equal stores: local and 4 tasks on 2 logins"
check_systems "${by_ssh[@]}"
compgen -G "$work/home/one/.stillpoint/jobs/*/system-0/toy.awk" >/dev/null || fail "the script was not copied"

# A recorded sequence that only this machine has is copied, once.
sequence="$(find "$work/cache" -name request.toml -printf '%h\n' | head -n 1)"
cp -r "$sequence" "$work/data/recorded_a"
printf 'title = "Recorded"\nvariants = ["stillpoint"]\nimages = 0\nmax_frames = 15\n[recorded]\nsequences = ["recorded_a"]\n' \
  >"$work/recorded.toml"
bench recorded recorded_local || fail "local execution of a recorded sequence: $(tail -n 3 "$work/bench-recorded_local.log")"
bench recorded recorded "${by_ssh[@]}" || fail "recorded sequence over ssh: $(tail -n 3 "$work/bench-recorded.log")"
grep -q 'copy recorded_a to one' "$work/bench-recorded.log" || fail "the sequence was not copied"
expect_equal recorded_local recorded
echo "equal stores with a copied sequence"

# Hosts without the program: a root file system that contains the libraries, too, and a Debian package.
libraries="$(uname -m)-linux-gnu"
mkdir -p "$work/root/usr/bin" "$work/root/usr/lib/$libraries/stillpoint" "$work/deb/DEBIAN" "$work/deb/usr/bin"
cp "$program" "$work/root/usr/bin"
cp "$program" "$work/deb/usr/bin"
modules=("$(dirname "$program")"/lib/libstillpoint_*.so)
cp "${modules[@]}" "$work/root/usr/lib/$libraries/stillpoint"
ldd "$program" "${modules[@]}" | grep -o '/[^ :]*\.so[^ :]*' | sort -u | xargs cp -L --target-directory="$work/root/usr/lib/$libraries"
cp "$(dirname "${BASH_SOURCE[0]}")/../../scripts/package/launcher.sh" "$work/root/stillpoint"
tar --create --use-compress-program='zstd --fast=5' --directory "$work/root" --file "$work/root.tar.zst" .
printf 'Package: stillpoint\nVersion: 0\nArchitecture: all\nMaintainer: x <x@example.org>\nDescription: test\n' \
  >"$work/deb/DEBIAN/control"
dpkg-deb --build --root-owner-group -Znone "$work/deb" "$work/program.deb" >/dev/null
rm -r "$work"/home/*/.stillpoint
printf 'one package=%s\ntwo package=%s\n' "$work/root.tar.zst" "$work/program.deb" >"$work/package_hosts"
bench plan packages --executor ssh --hosts "$work/package_hosts" --ssh-config "$work/ssh_config" --tasks 4 ||
  fail "execution of packages: $(tail -n 3 "$work/bench-packages.log")"
[[ "$(readlink -f "$work"/home/one/.stillpoint/jobs/*/program)" == "$work"/home/one/.stillpoint/packages/*/stillpoint ]] ||
  fail "host one did not use its root file system"
expect_equal local packages
echo "equal stores with copied programs"

# The calling program and a worker are killed; a host that cannot be reached is left out.
write_plan many 5
bench many many_local --jobs 2 || fail "local execution of 20 runs"
bench many killed "${by_ssh[@]}" &
caller=$!
job() { basename "$work"/killed.sqlite.jobs/*; }
has_store() { compgen -G "$work/home/*/.stillpoint/jobs/$(job)/store-*.sqlite" >/dev/null; }
wait_until 60 has_store
kill -KILL "$(pgrep -P "$caller" -f "$program bench" | head -n 1 || echo "$caller")" "$caller" 2>/dev/null || true
wait "$caller" 2>/dev/null || true
worker="$(pgrep -f "program worker run .stillpoint/jobs/$(job)" | head -n 1 || true)"
[[ -z "$worker" ]] || kill -KILL "$worker" 2>/dev/null || true
printf 'absent\n' >>"$work/hosts"
bench many killed "${by_ssh[@]}" || fail "continued execution: $(tail -n 3 "$work/bench-killed.log")"
grep -q 'host absent is left out' "$work/bench-killed.log" || fail "no message for the host that cannot be reached"
expect_equal many_local killed
echo "equal stores after a worker and the calling program were killed"

printf 'one;touch${IFS}x\n' >"$work/bad_hosts"
! bench plan bad --executor ssh --hosts "$work/bad_hosts" || fail "a host name with a semicolon was accepted"
grep -q 'bad_hosts:1: host' "$work/bench-bad.log" || fail "no line of the invalid host"
echo "invalid host names are rejected"
