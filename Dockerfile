# The two commands of README.md on Debian 12:
#   docker build -t stratum . && docker run --rm stratum
# docker build runs the first, which ends with a picture; docker run runs the tests.
FROM debian:12
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates git && rm -rf /var/lib/apt/lists/*
COPY . /stratum
WORKDIR /stratum
RUN bash scripts/demo.sh
CMD ["bash", "scripts/test.sh"]
