# A PostgreSQL and an S3-compatible store for the tests, in a folder of their own; `stop_services` ends both.

services=$(mktemp -d /tmp/palpate-services.XXXXXX)

# PostgreSQL does not run as root.
unprivileged() {
    if [ "$(id -u)" = 0 ]; then runuser -u postgres -- "$@"; else "$@"; fi
}

postgresql_programs() {
    dirname "$(ls /usr/lib/postgresql/*/bin/initdb 2>/dev/null | sort -V | tail -n 1)"
}

start_postgresql() {
    if [ ! -x "$(postgresql_programs)/initdb" ]; then
        echo "== installing PostgreSQL"
        apt-get update -qq
        DEBIAN_FRONTEND=noninteractive apt-get install -y -qq postgresql > "$services/apt.log" 2>&1 || {
            cat "$services/apt.log" >&2
            return 1
        }
    fi
    echo "== starting PostgreSQL"
    local programs data="$services/postgresql"
    programs=$(postgresql_programs)
    chmod 755 "$services"
    mkdir "$data"
    [ "$(id -u)" != 0 ] || chown postgres "$data"
    unprivileged "$programs/initdb" -D "$data/data" -U palpate -A trust -E UTF8 --no-sync > "$services/initdb.log"
    # a socket in the folder and no port: nothing else on the machine is in the way
    cat > "$services/control" <<END
#!/usr/bin/env bash
cd /
exec $( [ "$(id -u)" != 0 ] || echo runuser -u postgres -- ) $programs/pg_ctl -D $data/data -l $data/log -w -s -m fast \
    -o "-k $data -c listen_addresses='' -c fsync=off" "\$@"
END
    chmod +x "$services/control"
    "$services/control" start
    export PALPATE_TEST_POSTGRESQL="postgresql+psycopg://palpate@/postgres?host=$data"
    export PALPATE_TEST_POSTGRESQL_RESTART="$services/control restart"
}

# The browser tests take it from the path.
install_chromium() {
    [ -z "$(command -v chromium)" ] || return 0
    echo "== installing Chromium"
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq chromium > "$services/apt.log" 2>&1 || {
        cat "$services/apt.log" >&2
        return 1
    }
}

start_s3() {
    echo "== starting an S3-compatible store"
    local port
    port=$(.venv/bin/python -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
    .venv/bin/moto_server -H 127.0.0.1 -p "$port" > "$services/s3.log" 2>&1 &
    echo $! > "$services/s3.pid"
    for _ in $(seq 100); do
        if .venv/bin/python -c "import socket; socket.create_connection(('127.0.0.1', $port), 1)" 2> /dev/null; then
            export PALPATE_TEST_S3="http://127.0.0.1:$port"
            return
        fi
        sleep 0.2
    done
    cat "$services/s3.log" >&2
    return 1
}

stop_services() {
    [ ! -x "$services/control" ] || "$services/control" stop || true
    [ ! -f "$services/s3.pid" ] || kill "$(cat "$services/s3.pid")" 2> /dev/null || true
    rm -rf "$services"
}
